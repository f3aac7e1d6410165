// SPDX-License-Identifier: BSD-3-Clause
//
// Tells the thread sanitizer how oneTBB hands work from thread to thread. Only in programs that are built with it (preset `tsan`).
//
// libtbb as distributions ship it is not instrumented: a task goes to another thread through atomics that the sanitizer does not see, and
// everything that was written before the task was spawned would look like a race. These are the library's own entry points (tbb/detail),
// found before it by the loader: each says what the real one promises, and calls it. Nothing is suppressed. All else, joins of loops, lists per
// thread, lies in TBB's headers, which are compiled with us. What promises nothing is not here: a hand-over that is missing shows as false
// reports, never as silence.
#include <sanitizer/tsan_interface.h>

#include <dlfcn.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <cstdlib>
#include <new>

namespace tbb::detail {

namespace {

// The library's function of the same name and type as ours.
template <class Function>
Function* next(Function* /*type*/, const char* symbol) {
    void* const found = dlsym(RTLD_NEXT, symbol);
    if (!found) std::abort();  // another version of oneTBB
    return reinterpret_cast<Function*>(found);
}

// A task in whose place it runs: what was done before it was spawned happens before it. Others may wait for its end by the reference
// counts in TBB's headers, which the sanitizer sees.
class HandedOver final : public d1::task {
public:
    explicit HandedOver(d1::task& task) : task_(task) { __tsan_release(this); }

    d1::task* execute(d1::execution_data& data) override { return received().execute(data); }
    d1::task* cancel(d1::execution_data& data) override { return received().cancel(data); }

private:
    d1::task& received() {
        __tsan_acquire(this);
        d1::task& task = task_;
        delete this;
        return task;
    }

    d1::task& task_;
};

// The body of task_arena::execute, which runs on a thread of the arena where the caller finds no place in it.
class HandedOverBody final : public d1::delegate_base {
public:
    explicit HandedOverBody(d1::delegate_base& body) : body_(body) { __tsan_release(this); }

    bool operator()() const override {
        __tsan_acquire(const_cast<HandedOverBody*>(this));
        const bool result = body_();
        __tsan_release(const_cast<HandedOverBody*>(this));
        return result;
    }

private:
    d1::delegate_base& body_;
};

}  // namespace

namespace r1 {

void spawn(d1::task& task, d1::task_group_context& context) {
    static const auto real = next(static_cast<void (*)(d1::task&, d1::task_group_context&)>(&spawn),
                                  "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
    real(*new HandedOver(task), context);
}

void execute_and_wait(d1::task& task, d1::task_group_context& context, d1::wait_context& end, d1::task_group_context& waiting) {
    static const auto real = next(&execute_and_wait, "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_contextES6_");
    real(task, context, end, waiting);
    // Its count of references, behind 8 bytes of flags: the last one who left it did so before.
    __tsan_acquire(reinterpret_cast<char*>(&end) + sizeof(std::uint64_t));
}

void execute(d1::task_arena_base& arena, d1::delegate_base& body) {
    static const auto real =
        next(static_cast<void (*)(d1::task_arena_base&, d1::delegate_base&)>(&execute), "_ZN3tbb6detail2r17executeERNS0_2d115task_arena_baseERNS2_13delegate_baseE");
    HandedOverBody handed_over(body);
    real(arena, handed_over);
    __tsan_acquire(&handed_over);
}

// Memory of tasks, which TBB keeps in pools and gives to other threads: here it comes from where the sanitizer knows it. 64 bytes: tasks
// are aligned so.
void* allocate(d1::small_object_pool*& pool, std::size_t bytes) {
    static char some_pool;  // never looked into, but must not be null
    pool = reinterpret_cast<d1::small_object_pool*>(&some_pool);
    return ::operator new(bytes, std::align_val_t{64});
}
void* allocate(d1::small_object_pool*& pool, std::size_t bytes, const d1::execution_data& /*data*/) { return allocate(pool, bytes); }
void deallocate(d1::small_object_pool& /*pool*/, void* memory, std::size_t /*bytes*/) { ::operator delete(memory, std::align_val_t{64}); }
void deallocate(d1::small_object_pool& pool, void* memory, std::size_t bytes, const d1::execution_data& /*data*/) { deallocate(pool, memory, bytes); }

}  // namespace r1
}  // namespace tbb::detail
