// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "mesh/error.hpp"
#include "mesh/text_file.hpp"
#include "project/camera.hpp"

namespace cellproj {

namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& place, std::string expected, std::string found, std::string advice = {}) {
    throw Error({ErrorKind::format, place, std::move(expected), std::move(found), std::move(advice)});
}

const json& member(const json& object, const char* key, const std::string& place) {
    const auto found = object.find(key);
    if (found == object.end()) fail(place, std::string("the key \"") + key + "\"", "none");
    return *found;
}

double number(const json& value, const std::string& place) {
    if (!value.is_number()) fail(place, "a number", value.dump());
    return value.get<double>();
}

glm::dvec3 vector(const json& value, const std::string& place) {
    if (!value.is_array() || value.size() != 3) fail(place, "an array of three numbers", value.dump());
    return {number(value[0], place), number(value[1], place), number(value[2], place)};
}

Camera camera_from(const json& object, const std::string& place) {
    if (!object.is_object()) fail(place, "a camera: {\"projection\": ..., \"eye\": ..., ...}", object.dump().substr(0, 60));
    const std::string projection = member(object, "projection", place).dump();
    const bool parallel = projection == "\"parallel\"";
    if (!parallel && projection != "\"perspective\"") {
        fail(place + ", projection", "\"parallel\" or \"perspective\"", projection);
    }
    const char* size_key = parallel ? "height" : "fov_y_degrees";
    const std::vector<std::string> known{"projection", "eye", "center", "up", size_key};
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    require_known_keys(place, keys, known);

    Camera camera;
    camera.projection = parallel ? Camera::Projection::parallel : Camera::Projection::perspective;
    camera.eye = vector(member(object, "eye", place), place + ", eye");
    camera.center = vector(member(object, "center", place), place + ", center");
    camera.up = vector(member(object, "up", place), place + ", up");
    (parallel ? camera.height : camera.fov_y_degrees) = number(member(object, size_key, place), place + ", " + size_key);
    validate(camera, place);
    return camera;
}

}  // namespace

std::vector<Camera> parse_cameras(std::string_view text, const std::string& place) {
    json document;
    try {
        document = json::parse(text);
    } catch (const json::exception& error) {
        fail(place, "JSON", error.what(), "check the text near that place");
    }
    if (!document.is_array()) return {camera_from(document, place)};
    if (document.empty()) fail(place, "at least one camera", "an empty array");
    std::vector<Camera> cameras;
    for (std::size_t i = 0; i < document.size(); ++i) {
        cameras.push_back(camera_from(document[i], place + ", camera " + std::to_string(i)));
    }
    return cameras;
}

std::vector<Camera> read_cameras(const std::filesystem::path& file) {
    return parse_cameras(read_text_file(file, "a readable camera file (JSON)"), file.string());
}

std::string to_json(const Camera& camera) {
    const auto array = [](const glm::dvec3& v) { return json{v.x, v.y, v.z}; };
    const bool parallel = camera.projection == Camera::Projection::parallel;
    json object{{"projection", parallel ? "parallel" : "perspective"},
                {"eye", array(camera.eye)},
                {"center", array(camera.center)},
                {"up", array(camera.up)}};
    if (parallel) object["height"] = camera.height;
    if (!parallel) object["fov_y_degrees"] = camera.fov_y_degrees;
    return object.dump();
}

}  // namespace cellproj
