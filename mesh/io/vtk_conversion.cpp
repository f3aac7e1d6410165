// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/vtk_conversion.hpp"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <cmath>
#include <exception>
#include <mutex>
#include <new>

#include "mesh/error.hpp"
#include "mesh/io/isolated_read.hpp"

namespace cellproj {

namespace {

// Keeps the first error and drops the rest. A "generic warning" is an error here: that is how the legacy reader tells
// that the data of an array ended too early. Other warnings are about what does not matter (keys of modules not
// linked).
class FirstError : public vtkOutputWindow {
public:
    static FirstError* New();
    vtkTypeMacro(FirstError, vtkOutputWindow)

        void DisplayText(const char*) override {}
    void DisplayErrorText(const char* text) override {
        if (message.empty()) message = text;
    }
    void DisplayGenericWarningText(const char* text) override { DisplayErrorText(text); }
    void DisplayWarningText(const char*) override {}
    void DisplayDebugText(const char*) override {}

    std::string message;
};

vtkStandardNewMacro(FirstError)

    // While one lives, VTK's messages go to a FirstError. VTK sends each to its output window and to its log; the log's
    // threshold can be asked for only as the loosest of all log sinks, which is what is put back.
    class CapturedMessages {
public:
    CapturedMessages()
        : lock_(mutex()), window_(vtkOutputWindow::GetInstance()), verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
        vtkOutputWindow::SetInstance(captured_);
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    }
    ~CapturedMessages() {
        vtkLogger::SetStderrVerbosity(verbosity_);
        vtkOutputWindow::SetInstance(window_);
    }
    CapturedMessages(const CapturedMessages&) = delete;
    CapturedMessages& operator=(const CapturedMessages&) = delete;

    const std::string& first_error() const { return captured_->message; }

private:
    static std::mutex& mutex() {
        static std::mutex only;
        return only;
    }

    std::lock_guard<std::mutex> lock_;
    vtkSmartPointer<vtkOutputWindow> window_;
    vtkLogger::Verbosity verbosity_;
    vtkNew<FirstError> captured_;
};

// "ERROR: In FILE, line N\nvtkClass (0x…): what is wrong\n\n" → "what is wrong", its first line.
std::string shortened(const std::string& message) {
    constexpr std::size_t longest = 200;
    const std::size_t place_end = message.find('\n');
    const std::size_t object_end = message.find("): ");
    std::size_t begin = place_end == std::string::npos ? 0 : place_end + 1;
    if (object_end != std::string::npos) begin = object_end + 3;
    const std::string line = message.substr(begin, message.find('\n', begin) - begin);
    return printable(line.size() <= longest ? line : line.substr(0, longest) + "...");
}

[[noreturn]] void throw_unreadable(const std::filesystem::path& file, const std::string& message) {
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a complete and well-formed file",
                 .found = "what VTK's reader calls \"" + shortened(message) + "\"",
                 .advice = "the file may be cut off or damaged: write or copy it again"});
}

template <class RowOf>
Field gather_rows(vtkDataArray& array, const std::string& name, std::size_t count, RowOf row_of) {
    const auto components = static_cast<std::size_t>(array.GetNumberOfComponents());
    Field field{name, array.GetNumberOfComponents(), std::vector<double>(count * components)};
    for (std::size_t i = 0; i < count; ++i)
        array.GetTuple(row_of(i), field.values.data() + i * components);
    return field;
}

}  // namespace

void capture_errors(const std::filesystem::path& file, const std::function<void()>& work) {
    const CapturedMessages messages;
    try {
        work();
    } catch (const std::bad_alloc&) {
        throw;  // told by the child process in which this happens (isolated_read.hpp)
    } catch (const std::exception& exception) {
        throw_unreadable(file, messages.first_error().empty() ? exception.what() : messages.first_error());
    }
    if (!messages.first_error().empty()) throw_unreadable(file, messages.first_error());
}

void update(vtkAlgorithm& reader, const std::filesystem::path& file) {
    vtkNew<vtkCallbackCommand> progress;
    progress->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
        report_progress(static_cast<vtkAlgorithm*>(caller)->GetProgress());
    });
    const unsigned long observer = reader.AddObserver(vtkCommand::ProgressEvent, progress);
    capture_errors(file, [&] { reader.Update(); });
    reader.RemoveObserver(observer);
}

std::vector<glm::dvec3> to_points(vtkPoints& points, const std::filesystem::path& file) {
    const auto count = static_cast<std::size_t>(points.GetNumberOfPoints());
    if (count > max_elements) {
        throw Error({.kind = ErrorKind::data,
                     .place = file.string(),
                     .expected = "at most " + std::to_string(max_elements) + " points (ids have 32 bits)",
                     .found = std::to_string(count),
                     .advice = "cut the data into parts"});
    }
    std::vector<glm::dvec3> result(count);
    for (std::size_t i = 0; i < count; ++i) {
        glm::dvec3& p = result[i];
        points.GetPoint(static_cast<vtkIdType>(i), &p.x);
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
        throw Error({.kind = ErrorKind::data,
                     .place = file.string() + ", point " + std::to_string(i),
                     .expected = "finite coordinates",
                     .found = "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ")",
                     .advice = "look for the program that wrote it: no cell can be drawn there"});
    }
    return result;
}

Field to_field(vtkDataArray& array, const std::string& name, std::span<const std::uint64_t> rows) {
    return gather_rows(array, name, rows.size(), [&](std::size_t i) { return static_cast<vtkIdType>(rows[i]); });
}

Field to_field(vtkDataArray& array, const std::string& name) {
    const auto rows = static_cast<std::size_t>(array.GetNumberOfTuples());
    return gather_rows(array, name, rows, [](std::size_t i) { return static_cast<vtkIdType>(i); });
}

void require_rows(vtkDataArray& array, const std::string& name, std::size_t rows, const std::filesystem::path& place) {
    if (array.GetNumberOfTuples() == static_cast<vtkIdType>(rows)) return;
    throw Error({.kind = ErrorKind::format,
                 .place = place.string() + ", array \"" + name + "\"",
                 .expected = std::to_string(rows) + " rows",
                 .found = std::to_string(array.GetNumberOfTuples()),
                 .advice = "the file is damaged: write it again"});
}

std::vector<Field> to_fields(vtkDataSetAttributes& attributes, std::size_t rows, const std::filesystem::path& place,
                             const std::function<Field(vtkDataArray&, const std::string&)>& convert) {
    std::vector<Field> fields;
    for (int i = 0, number = 0; i < attributes.GetNumberOfArrays(); ++i, ++number) {
        vtkDataArray* array = attributes.GetArray(i);
        if (!array || array->GetNumberOfComponents() < 1) continue;
        const std::string name = array->GetName() ? array->GetName() : "unnamed " + std::to_string(number);
        if (name == vtkDataSetAttributes::GhostArrayName()) continue;
        require_rows(*array, name, rows, place);
        fields.push_back(convert(*array, name));
        attributes.RemoveArray(i--);
    }
    return fields;
}

}  // namespace cellproj
