// SPDX-License-Identifier: BSD-3-Clause
#include "render/statistics.hpp"

#include <algorithm>
#include <cassert>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

namespace cellproj {

namespace {

using Json = nlohmann::ordered_json;  // keys stand in the file as they stand here

template <typename T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json order_check_json(const std::optional<OrderCheck>& check) {
    if (!check) return nullptr;
    return {{"rays", check->rays}, {"wrong_rays", check->wrong_rays}, {"wrong_pairs", check->wrong_pairs}};
}

Json plan_json(const std::vector<Decision>& plan) {
    Json decisions = Json::array();
    for (const Decision& d : plan) decisions.push_back({{"rule", d.rule}, {"chosen", d.chosen}, {"why", d.why}});
    return decisions;
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
              {"fragments", counts.fragments},
              {"unordered", counts.unordered},
              {"cycles", counts.cycles},
              {"split_cells", counts.split_cells},
              {"order_violations", or_null(counts.order_violations)}}},
            {"drawn_as", picture.drawn_as},
            {"method", picture.method},
            {"target", picture.target},
            {"table_bytes", picture.table_bytes},
            {"backend", picture.backend},
            {"backend_version", picture.backend_version},
            {"order", picture.order},
            {"order_exact", picture.order_exact},
            {"order_check", order_check_json(picture.order_check)},
            {"error", or_null(picture.error)},
            {"plan", plan_json(picture.plan)}};
}

}  // namespace

double median(std::vector<double> values) {
    assert(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// From /proc and not from getrusage, whose peak a program inherits from the one that launched it.
std::size_t peak_memory_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kibibytes = 0;
        if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
    }
    return 0;
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
