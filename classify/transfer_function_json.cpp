// SPDX-License-Identifier: BSD-3-Clause
//
// Transfer functions from JSON: cellproj's own strict form, and ParaView's exported colour maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "classify/color_space.hpp"
#include "classify/presets.hpp"
#include "classify/transfer_function.hpp"
#include "mesh/error.hpp"
#include "mesh/text_file.hpp"

namespace cellproj {

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(ErrorKind kind, const std::string& place, std::string expected, std::string found,
                       std::string advice) {
    throw Error({kind, place, std::move(expected), std::move(found), std::move(advice)});
}

// What stands there, short enough for a message.
std::string shown(const Json& value) {
    constexpr std::size_t longest = 60;
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > longest) text = text.substr(0, longest) + " …";
    return text;
}

std::string element(const std::string& place, std::size_t index) {
    return place + "[" + std::to_string(index) + "]";
}

// "PLACE:LINE:COLUMN" of a byte, both counted from 1.
std::string position_of(std::string_view text, std::size_t byte, const std::string& place) {
    const std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_start = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
    return place + ":" + std::to_string(line) + ":" + std::to_string(before.size() - line_start + 1);
}

// nlohmann-json keeps the last of two equal keys in silence; this callback refuses them.
class DuplicateKeys {
public:
    explicit DuplicateKeys(std::string place) : place_(std::move(place)) {}

    bool operator()(Json::parse_event_t event, const Json& parsed) {
        if (event == Json::parse_event_t::object_start) open_.emplace_back();
        if (event == Json::parse_event_t::object_end) open_.pop_back();
        if (event == Json::parse_event_t::key && !open_.back().insert(parsed.get<std::string>()).second)
            fail(ErrorKind::format, place_, "each key once", "the key " + shown(parsed) + " twice",
                 "remove one of them");
        return true;
    }

private:
    std::string place_;
    std::vector<std::set<std::string>> open_;  // keys of the objects that are being read
};

Json parse_strict(std::string_view text, const std::string& place) {
    DuplicateKeys duplicates(place);
    try {
        return Json::parse(text.begin(), text.end(), [&](int, Json::parse_event_t event, const Json& parsed) {
            return duplicates(event, parsed);
        });
    } catch (const Json::parse_error& error) {
        const std::string what = error.what();
        const std::size_t detail = what.find("syntax error");
        fail(ErrorKind::format, position_of(text, error.byte, place), "JSON",
             detail == what.npos ? what : what.substr(detail),
             "check quotes, commas and brackets there; NaN and Infinity are no JSON numbers");
    } catch (const Json::out_of_range& error) {
        fail(ErrorKind::format, place, "numbers that float64 can hold", error.what(), "use a smaller number");
    }
}

double number(const Json& value, const std::string& place) {
    if (!value.is_number()) fail(ErrorKind::format, place, "a number", shown(value), "write a number there");
    return value.get<double>();
}

// `layout` names the numbers of a node, as "[s, r, g, b]".
template <std::size_t N>
std::vector<std::array<double, N>> read_nodes(const Json& list, const std::string& place, const std::string& layout) {
    if (!list.is_array()) fail(ErrorKind::format, place, "a list of " + layout, shown(list), "write a list of nodes");
    std::vector<std::array<double, N>> nodes;
    for (const Json& item : list) {
        const std::string here = element(place, nodes.size());
        if (!item.is_array() || item.size() != N)
            fail(ErrorKind::format, here, layout, shown(item), "give each node " + std::to_string(N) + " numbers");
        std::array<double, N>& node = nodes.emplace_back();
        for (std::size_t k = 0; k < N; ++k)
            node[k] = number(item[k], element(here, k));
    }
    return nodes;
}

std::vector<ColorNode> color_nodes(const std::vector<std::array<double, 4>>& numbers) {
    std::vector<ColorNode> nodes;
    nodes.reserve(numbers.size());
    for (const auto& [s, r, g, b] : numbers)
        nodes.push_back({s, {r, g, b}});
    return nodes;
}

// The value named by the word under `key`; the first of `names` when the key is absent.
template <class Value>
Value choice(const Json& object, const std::string& key, const std::string& place,
             const std::vector<std::pair<std::string, Value>>& names) {
    const auto entry = object.find(key);
    if (entry == object.end()) return names.front().second;
    const std::string here = place + ": " + key;
    std::string known;
    std::vector<std::string> words;
    for (const auto& [name, value] : names) {
        if (*entry == name) return value;
        known += (known.empty() ? "\"" : " or \"") + name + "\"";
        words.push_back(name);
    }
    if (!entry->is_string()) fail(ErrorKind::format, here, known, shown(*entry), "write one of these words");
    fail(ErrorKind::option, here, known, shown(*entry),
         "did you mean \"" + nearest_name(entry->get<std::string>(), words) + "\"?");
}

const Json& require(const Json& object, const std::string& key, const std::string& place, const std::string& advice) {
    const auto entry = object.find(key);
    if (entry == object.end()) fail(ErrorKind::format, place, "the key \"" + key + "\"", "none", advice);
    return *entry;
}

// The colours of a preset over "range".
std::vector<ColorNode> read_preset(const Json& object, ScalarAxis axis, const std::string& place) {
    const Json &name = object["preset"], &range = require(object, "range", place, "add \"range\": [low, high]");
    if (!name.is_string())
        fail(ErrorKind::format, place + ": preset", "the name of a preset", shown(name), "write \"preset\": \"viridis\"");
    if (!range.is_array() || range.size() != 2)
        fail(ErrorKind::format, place + ": range", "[low, high]", shown(range), "give two scalars");
    const double low = number(range[0], place + ": range[0]"), high = number(range[1], place + ": range[1]");
    if (low > high) fail(ErrorKind::data, place + ": range", "[low, high] with low ≤ high", shown(range), "swap them");
    return preset_colors(name.get<std::string>(), low, high, axis, place + ": preset");
}

std::vector<ColorNode> read_color(const Json& object, ScalarAxis axis, const std::string& place) {
    const bool has_color = object.contains("color"), has_preset = object.contains("preset");
    if (has_color == has_preset)
        fail(ErrorKind::format, place, "either the key \"color\" or the key \"preset\"", has_color ? "both" : "neither",
             has_color ? "remove one of them" : "add \"color\": [[s, r, g, b], …]");
    if (has_preset) return read_preset(object, axis, place);
    if (object.contains("range"))
        fail(ErrorKind::format, place, "\"range\" only together with \"preset\"", "it beside \"color\"",
             "remove it: the nodes of \"color\" have their scalars");
    return on_axis(color_nodes(read_nodes<4>(object["color"], place + ": color", "[s, r, g, b]")), axis, place);
}

std::vector<ExtinctionNode> read_extinction(const Json& object, ScalarAxis axis, const std::string& place) {
    for (const char* key : {"unit_distance", "opacity_convention"})
        if (object.contains(key))
            fail(ErrorKind::format, place, "\"" + std::string(key) + "\" only together with \"opacity\"",
                 "it beside \"extinction\"", "remove it: extinction is per mesh unit already");
    std::vector<ExtinctionNode> nodes;
    for (const auto& [s, tau] : read_nodes<2>(object["extinction"], place + ": extinction", "[s, tau]"))
        nodes.push_back({s, tau});
    return on_axis(std::move(nodes), axis, place);
}

std::vector<ExtinctionNode> read_opacity(const Json& object, ScalarAxis axis, const std::string& place) {
    const Json& distance = require(object, "unit_distance", place,
                                   "add \"unit_distance\": u, the length [mesh units] that the opacities hold for");
    const auto convention = choice<OpacityConvention>(
        object, "opacity_convention", place,
        {{"exponential", OpacityConvention::exponential}, {"linear", OpacityConvention::linear}});
    std::vector<OpacityNode> nodes;
    for (const auto& [s, alpha] : read_nodes<2>(object["opacity"], place + ": opacity", "[s, alpha]"))
        nodes.push_back({s, alpha});
    return extinction_from_opacity(nodes, number(distance, place + ": unit_distance"), convention, place, axis);
}

TransferFunction from_object(const Json& object, const std::string& place) {
    static const std::vector<std::string> known{"model",   "color",         "preset",             "range",   "extinction",
                                                "opacity", "unit_distance", "opacity_convention", "outside", "axis"};
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items())
        keys.push_back(key);
    require_known_keys(place, keys, known);

    const auto model = choice<OpticalModel>(object, "model", place,
                                            {{"density", OpticalModel::density}, {"emitter", OpticalModel::emitter}});
    const auto outside =
        choice<Outside>(object, "outside", place, {{"clamp", Outside::clamp}, {"transparent", Outside::transparent}});
    const auto axis =
        choice<ScalarAxis>(object, "axis", place, {{"linear", ScalarAxis::linear}, {"log", ScalarAxis::log}});
    std::vector<ColorNode> color = read_color(object, axis, place);
    const bool has_extinction = object.contains("extinction"), has_opacity = object.contains("opacity");
    if (has_extinction == has_opacity)
        fail(ErrorKind::format, place, "either \"extinction\" or \"opacity\"", has_opacity ? "both" : "neither",
             has_opacity ? "remove one of them" : "add \"extinction\": [[s, tau], …]");
    return {model, std::move(color), has_opacity ? read_opacity(object, axis, place) : read_extinction(object, axis, place),
            outside, place};
}

// ParaView's flat list of four numbers a node.
std::vector<std::array<double, 4>> read_quadruples(const Json& list, const std::string& place) {
    if (!list.is_array() || list.empty() || list.size() % 4 != 0)
        fail(ErrorKind::format, place, "a list of 4 numbers for each node", shown(list), "export the colour map again");
    std::vector<std::array<double, 4>> nodes(list.size() / 4);
    for (std::size_t k = 0; k < list.size(); ++k)
        nodes[k / 4][k % 4] = number(list[k], element(place, k));
    return nodes;
}

// The colour at a share 0..1 of the way between two.
using Interpolation = glm::dvec3 (*)(const glm::dvec3&, const glm::dvec3&, double);

// Inserts the shares at which straight lines in RGB must bend to stay within 1e-3 of the interpolation between begin and end.
// Where the curve has a kink between the samples they show at least three quarters of its distance from the chord. Kinks (the
// sectors of HSV) end the search at 1/2048: there they bend by at most 6 per share, which a line so short misses by 6/2048/4.
void insert_bends(const Interpolation& interpolation, const glm::dvec3& from, const glm::dvec3& to, double begin, double end,
                  std::vector<double>& shares) {
    const auto at = [&](double share) { return interpolation(from, to, share); };
    bool straight = true;
    for (const double t : {0.25, 0.5, 0.75}) {
        const glm::dvec3 error = glm::abs(at(std::lerp(begin, end, t)) - glm::mix(at(begin), at(end), t));
        straight = straight && std::max({error.r, error.g, error.b}) <= 0.75e-3;
    }
    // Sixteen lines at least: the hue of a dark colour on its way to white turns more than once.
    if (end - begin <= 1.0 / 2048 || (straight && end - begin <= 1.0 / 16)) return;
    const double middle = 0.5 * (begin + end);
    insert_bends(interpolation, from, to, begin, middle, shares);
    shares.push_back(middle);
    insert_bends(interpolation, from, to, middle, end, shares);
}

// Nodes between which straight lines in RGB follow a curved interpolation.
std::vector<ColorNode> straightened(const std::vector<ColorNode>& nodes, Interpolation interpolation, ScalarAxis axis) {
    std::vector<ColorNode> fine;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        std::vector<double> shares;
        if (i > 0) insert_bends(interpolation, nodes[i - 1].color, nodes[i].color, 0.0, 1.0, shares);
        for (const double share : shares) {
            const double s = scalar_between(nodes[i - 1].scalar, nodes[i].scalar, share, axis);
            if (s > fine.back().scalar && s < nodes[i].scalar)
                fine.push_back({s, interpolation(nodes[i - 1].color, nodes[i].color, share)});
        }
        fine.push_back(nodes[i]);
    }
    return fine;
}

// ParaView's colour space "Step": an interval has the colour of its end.
std::vector<ColorNode> steps_between(const std::vector<ColorNode>& nodes) {
    std::vector<ColorNode> steps{nodes.front()};
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        if (nodes[i].scalar == nodes[i - 1].scalar) continue;
        steps.push_back({nodes[i - 1].scalar, nodes[i].color});
        steps.push_back(nodes[i]);
    }
    return steps;
}

// ParaView writes 0 and 1 where JSON has false and true.
bool flag(const Json& map, const std::string& key, const std::string& place) {
    const auto entry = map.find(key);
    if (entry == map.end()) return false;
    if (entry->is_boolean()) return entry->get<bool>();
    if (*entry != 0 && *entry != 1)
        fail(ErrorKind::format, place + ": " + key, "0, 1, true or false", shown(*entry), "write one of these");
    return *entry == 1;
}

// Nodes checked while they have the file's numbering. The colour spaces are defined for what a screen shows.
std::vector<ColorNode> paraview_nodes(const Json& map, const std::string& place) {
    std::vector<ColorNode> nodes = color_nodes(read_quadruples(map["RGBPoints"], place + ": RGBPoints"));
    nodes = on_axis(std::move(nodes), ScalarAxis::linear, place);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const glm::dvec3& c = nodes[i].color;
        if (std::max({c.r, c.g, c.b}) > 1.0)
            fail(ErrorKind::data, element(place + ": color", i), "color components in 0 .. 1", shown({c.r, c.g, c.b}),
                 "correct this node");
    }
    return nodes;
}

std::vector<ColorNode> paraview_colors(const Json& map, ScalarAxis axis, const std::string& place) {
    std::vector<ColorNode> nodes = paraview_nodes(map, place);
    enum class Space { rgb, hsv, lab, diverging, step };
    switch (choice<Space>(map, "ColorSpace", place,
                          {{"RGB", Space::rgb},
                           {"HSV", Space::hsv},
                           {"Lab", Space::lab},
                           {"Diverging", Space::diverging},
                           {"Step", Space::step}})) {
        case Space::rgb: break;
        case Space::hsv:
            nodes = straightened(nodes, flag(map, "HSVWrap", place) ? interpolate_hsv_wrapped : interpolate_hsv, axis);
            break;
        case Space::lab: nodes = straightened(nodes, interpolate_lab, axis); break;
        case Space::diverging: nodes = straightened(nodes, interpolate_diverging, axis); break;
        case Space::step: nodes = steps_between(nodes); break;
    }
    return on_axis(std::move(nodes), axis, place);
}

std::vector<ExtinctionNode> paraview_extinction(const Json& map, ScalarAxis axis, const std::string& place,
                                                double unit_distance) {
    const Json& points = require(map, "Points", place, "export the colour map together with its opacity points");
    std::vector<OpacityNode> nodes;
    for (const auto& [s, alpha, midpoint, sharpness] : read_quadruples(points, place + ": Points")) {
        if (midpoint != 0.5 || sharpness != 0.0)
            fail(ErrorKind::data, element(place + ": Points", 4 * nodes.size()),
                 "midpoint 0.5 and sharpness 0 (straight lines)", shown({midpoint, sharpness}),
                 "reset midpoint and sharpness in ParaView's opacity editor");
        nodes.push_back({s, alpha});
    }
    const auto added = map.find("unit_distance");
    const double distance = added == map.end() ? unit_distance : number(*added, place + ": unit_distance");
    return extinction_from_opacity(nodes, distance, OpacityConvention::exponential, place, axis);
}

// The names of ParaView's maps; empty for a document that is no list of them.
std::vector<std::string> map_names(const Json& document) {
    std::vector<std::string> names;
    if (!document.is_array()) return names;
    for (const Json& map : document) {
        if (!map.is_object()) return {};
        const auto name = map.find("Name");
        names.push_back(name != map.end() && name->is_string() ? name->get<std::string>() : "");
    }
    return names;
}

// The map of this name, or the only one.
const Json& chosen_map(const Json& document, const std::string& name, const std::string& place) {
    const std::vector<std::string> names = map_names(document);
    if (name.empty() && names.size() <= 1) return names.empty() ? document : document[0];
    if (names.empty())
        fail(ErrorKind::option, place, "a list of ParaView's colour maps to choose \"" + name + "\" from", shown(document),
             "leave #" + name + " out");
    const auto found = std::find(names.begin(), names.end(), name);
    if (!name.empty() && found != names.end()) return document[static_cast<std::size_t>(found - names.begin())];
    fail(ErrorKind::option, place, name.empty() ? "the name of one of its " + std::to_string(names.size()) + " colour maps"
                                                : "one of the " + std::to_string(names.size()) + " colour maps of the file",
         name.empty() ? "none" : '"' + name + '"',
         "write " + place + "#NAME, such as " + place + "#" + (name.empty() ? names.front() : nearest_name(name, names)));
}

}  // namespace

TransferFunction parse_transfer_function(std::string_view json, const std::string& place, double paraview_unit_distance,
                                         std::string_view map_name) {
    const Json document = parse_strict(json, place);
    // ParaView exports a list of presets; its other keys (name, creator, colour of NaN …) say nothing about light.
    const Json& map = chosen_map(document, std::string(map_name), place);
    if (map.is_object() && map.contains("IndexedColors"))
        fail(ErrorKind::format, place, "colours over a scalar (\"RGBPoints\")", "\"IndexedColors\", colours of categories",
             "switch off \"Interpret Values As Categories\" in ParaView and export again");
    if (map.is_object() && map.contains("RGBPoints")) {
        const auto axis = flag(map, "UseLogScale", place) ? ScalarAxis::log : ScalarAxis::linear;
        return {OpticalModel::density, paraview_colors(map, axis, place),
                paraview_extinction(map, axis, place, paraview_unit_distance), Outside::clamp, place};
    }
    if (!document.is_object())
        fail(ErrorKind::format, place, "an object {…} or one colour map exported from ParaView", shown(document),
             "write {\"color\": [[s, r, g, b], …], \"extinction\": [[s, tau], …]}");
    return from_object(document, place);
}

TransferFunction read_transfer_function(const std::filesystem::path& file, double paraview_unit_distance) {
    const std::string word = file.string();
    const std::size_t mark = word.rfind('#');
    const bool named = mark != word.npos && !std::filesystem::exists(file);
    const std::filesystem::path path = named ? std::filesystem::path(word.substr(0, mark)) : file;
    return parse_transfer_function(read_text_file(path, "a readable transfer function (JSON)"), path.string(),
                                   paraview_unit_distance, named ? std::string_view(word).substr(mark + 1) : "");
}

}  // namespace cellproj
