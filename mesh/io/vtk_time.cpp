// SPDX-License-Identifier: BSD-3-Clause
#include <vtkAlgorithm.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <cmath>

#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

std::size_t nearest_time(const std::vector<double>& times, std::optional<double> wanted) {
    if (!wanted) return static_cast<std::size_t>(std::max_element(times.begin(), times.end()) - times.begin());
    const auto distance = [&](double time) { return std::abs(time - *wanted); };
    const auto nearest =
        std::min_element(times.begin(), times.end(), [&](double a, double b) { return distance(a) < distance(b); });
    return static_cast<std::size_t>(nearest - times.begin());
}

TimeSteps choose_time(vtkAlgorithm& reader, const std::filesystem::path& file, std::optional<double> wanted) {
    TimeSteps steps;
    capture_errors(file, [&] {
        reader.UpdateInformation();
        vtkInformation* information = reader.GetOutputInformation(0);
        if (!information || !information->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS())) return;
        const double* first = information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
        steps.all.assign(first, first + information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()));
        if (steps.all.empty()) return;
        steps.read = steps.all[nearest_time(steps.all, wanted)];
        information->Set(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP(), *steps.read);
    });
    return steps;
}

Dataset read_blocks(vtkAlgorithm& reader, const std::filesystem::path& file, const std::string& format,
                    const ReadOptions& options) {
    const TimeSteps steps = choose_time(reader, file, options.time);
    update(reader, file);
    Dataset dataset = blocks_to_dataset(*reader.GetOutputDataObject(0), file, format, options);
    dataset.times = steps.all;
    dataset.time = steps.read;
    return dataset;
}

}  // namespace cellproj
