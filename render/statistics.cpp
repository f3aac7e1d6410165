// SPDX-License-Identifier: BSD-3-Clause
#include "render/statistics.hpp"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

namespace cellproj {

namespace {

using Json = nlohmann::ordered_json;  // keys stand in the file as they stand here

template <typename T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json picture_json(const Statistics& picture) {
    const auto& ms = picture.ms;
    const auto& counts = picture.counts;
    return {{"ms",
             {{"plan", ms.plan},
              {"sort", ms.sort},
              {"project", ms.project},
              {"draw", ms.draw},
              {"read_back", ms.read_back},
              {"total", ms.total},
              {"write", ms.write}}},
            {"counts",
             {{"cells", counts.cells},
              {"culled", counts.culled},
              {"drawn", counts.drawn},
              {"triangles", counts.triangles},
              {"unordered", counts.unordered},
              {"order_violations", or_null(counts.order_violations)}}},
            {"method", picture.method},
            {"backend", picture.backend},
            {"backend_version", picture.backend_version},
            {"order", picture.order},
            {"error", or_null(picture.error)}};
}

}  // namespace

std::size_t peak_memory_bytes() {
    // Linux hands the peak of the launching process down through fork and exec: a program started from one that holds
    // 500 MB never reports less than that.
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // counted in KiB
}

std::string to_json(const RunStatistics& run) {
    Json pictures = Json::array();
    for (const Statistics& picture : run.pictures)
        pictures.push_back(picture_json(picture));
    const Json json = {
        {"once",
         {{"ms",
           {{"read", run.once_ms.read},
            {"tetrahedralize", run.once_ms.tetrahedralize},
            {"prepare", run.once_ms.prepare}}}}},
        {"pictures", pictures},
        {"peak_memory_bytes", run.peak_memory_bytes},
    };
    // Names come from drivers and command lines: bytes that are no UTF-8 must not lose the numbers.
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace cellproj
