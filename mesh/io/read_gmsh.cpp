// SPDX-License-Identifier: BSD-3-Clause
//
// Gmsh reference manual, "MSH file format" and "Legacy formats". A file is a list of sections $Name … $EndName. Ascii
// and binary files hold the same numbers in the same order (but for the elements of version 2), so one reader serves
// both.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/io/curved_cells.hpp"
#include "mesh/io/gmsh_elements.hpp"
#include "mesh/io/text_cells.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

class GmshReader {
public:
    GmshReader(const std::filesystem::path& file, int subdivide) : scanner_(file), subdivide_(subdivide) {
        dataset_.source = file.string();
    }

    Dataset read();

private:
    // Numbers, in ascii or as the bytes of a C int, size_t or double.
    std::int64_t integer(std::string_view what) {
        return binary_ ? scanner_.raw<std::int32_t>(what) : scanner_.integer(what);
    }
    std::uint64_t size(std::string_view what);
    double real(std::string_view what) { return binary_ ? scanner_.raw<double>(what) : scanner_.number(what); }
    glm::dvec3 point();
    // How many things follow, each of at least so many bytes.
    std::size_t count(std::string_view what, std::size_t ascii_bytes, std::size_t binary_bytes);
    int dimension();

    void read_format();
    void read_section(const std::string& name);
    void read_entities();
    void read_nodes_2();
    void read_nodes_4();
    void read_elements_2();
    void read_elements_4();
    void read_view(bool of_nodes);
    GmshElementType element_type();
    void read_element(const GmshElementType& type);
    void add_labels(std::uint64_t tag, double physical, double entity);
    void number_nodes(const std::vector<std::uint64_t>& tags);
    Field& view_field(std::vector<Field>& fields, const std::string& name, int components, std::size_t rows);
    void finish();

    TextScanner scanner_;
    bool binary_ = false;
    bool version_2_ = false;
    Dataset dataset_;
    std::map<std::pair<int, std::int64_t>, double> physical_groups_;  // first one, by dimension and tag of the entity
    GmshTags nodes_;
    std::vector<std::uint64_t> cell_tags_;
    std::optional<GmshTags> cells_;  // of cell_tags_, made when a view asks for it
    Field physical_{"physical", 1, {}};
    Field entity_{"entity", 1, {}};
    bool has_elements_ = false;
    int subdivide_;
    CurvedCells curved_;
    std::vector<VertexId> element_nodes_;  // of the one at hand
};

// ---- Numbers ----

std::uint64_t GmshReader::size(std::string_view what) {
    if (binary_) return scanner_.raw<std::uint64_t>(what);
    const std::int64_t value = scanner_.integer(what);
    if (value < 0) scanner_.fail_word(std::string(what) + ", 0 or more");
    return static_cast<std::uint64_t>(value);
}

glm::dvec3 GmshReader::point() {
    glm::dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        result[axis] = binary_ ? scanner_.raw<double>("a coordinate") : scanner_.finite("a coordinate");
        if (std::isfinite(result[axis])) continue;
        scanner_.fail("a finite coordinate", std::to_string(result[axis]),
                      "look for the program that wrote it: no cell can be drawn there", ErrorKind::data);
    }
    return result;
}

std::size_t GmshReader::count(std::string_view what, std::size_t ascii_bytes, std::size_t binary_bytes) {
    const std::uint64_t things = size(what);
    scanner_.require_room(things, binary_ ? binary_bytes : ascii_bytes, what);
    return static_cast<std::size_t>(things);
}

int GmshReader::dimension() {
    const std::int64_t value = integer("the dimension of an entity");
    if (value < 0 || value > 3) scanner_.fail("the dimension of an entity, 0 to 3", std::to_string(value));
    return static_cast<int>(value);
}

// ---- Sections ----

void GmshReader::read_format() {
    if (scanner_.word("$MeshFormat") != "$MeshFormat") {
        scanner_.fail_word("$MeshFormat",
                           "is it a Gmsh mesh of version 2 or 4? Older ones: gmsh FILE -save -o NEW.msh");
    }
    const double version = scanner_.number("a version");
    version_2_ = version >= 2.0 && version < 3.0;
    if (!version_2_ && version != 4.1) {
        scanner_.fail_word("version 2.2 or 4.1", "write it again: gmsh FILE -save -format msh41 -o NEW.msh");
    }
    const std::int64_t type = scanner_.integer("a file type");
    if (type != 0 && type != 1) scanner_.fail_word("the file type 0 (ascii) or 1 (binary)");
    binary_ = type == 1;
    if (const std::int64_t bytes = scanner_.integer("a data size"); bytes != 8 && binary_) {
        scanner_.fail_word("the data size 8", "write it again on a machine of 64 bits");
    }
    scanner_.rest_of_line();
    if (binary_) {
        scanner_.tell_bytes();
        if (const auto one = scanner_.raw<std::int32_t>("the number 1"); one != 1) {
            scanner_.fail("the number 1 in the byte order of this machine", std::to_string(one),
                          "the file may come from a machine of the other byte order: write it in ascii");
        }
    }
    if (scanner_.word("$EndMeshFormat") != "$EndMeshFormat") scanner_.fail_word("$EndMeshFormat");
    dataset_.format = std::string("Gmsh MSH ") + (version_2_ ? "2, " : "4.1, ") + (binary_ ? "binary" : "ascii");
}

void GmshReader::read_section(const std::string& name) {
    scanner_.rest_of_line();
    if (name == "$Entities" && !version_2_) {
        read_entities();
    } else if (name == "$Nodes") {
        version_2_ ? read_nodes_2() : read_nodes_4();
    } else if (name == "$Elements") {
        if (has_elements_) scanner_.fail("one section $Elements", "a second one");
        version_2_ ? read_elements_2() : read_elements_4();
        has_elements_ = true;
    } else if (name == "$NodeData" || name == "$ElementData") {
        if (!has_elements_) scanner_.fail("$Nodes and $Elements before " + name, "none");
        read_view(name == "$NodeData");
    } else {
        scanner_.skip_past("$End" + name.substr(1));  // names, parametrizations, periodicity, …: nothing to draw
        return;
    }
    const std::string end = "$End" + name.substr(1);
    if (scanner_.word(end) != end) scanner_.fail_word(end);
}

void GmshReader::read_entities() {
    std::array<std::size_t, 4> counts{};
    for (std::size_t& n : counts)
        n = count("a number of entities", 8, 36);
    for (int dim = 0; dim < 4; ++dim) {
        for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dim)]; ++i) {
            const std::int64_t tag = integer("the tag of an entity");
            for (int k = 0; k < (dim == 0 ? 3 : 6); ++k)
                real("a bound of an entity");
            const std::size_t groups = count("a number of physical groups", 2, 4);
            for (std::size_t k = 0; k < groups; ++k) {
                // Negative for an entity that is turned around in the group.
                const auto group = static_cast<double>(std::abs(integer("the tag of a physical group")));
                physical_groups_.try_emplace({dim, tag}, group);
            }
            if (dim == 0) continue;
            const std::size_t borders = count("a number of bounding entities", 2, 4);
            for (std::size_t k = 0; k < borders; ++k)
                integer("the tag of a bounding entity");
        }
    }
}

void GmshReader::number_nodes(const std::vector<std::uint64_t>& tags) {
    if (dataset_.points.size() > max_elements) require_volume_mesh(dataset_);
    nodes_ = GmshTags(tags);
    if (!nodes_.unique()) {
        scanner_.fail("node tags that are all different", "one that stands twice", TextScanner::damaged,
                      ErrorKind::data);
    }
}

void GmshReader::read_nodes_2() {
    if (!dataset_.points.empty()) scanner_.fail("one section $Nodes", "a second one");
    const std::size_t nodes = scanner_.count("the number of nodes", binary_ ? 28 : 8);
    scanner_.rest_of_line();
    std::vector<std::uint64_t> tags(nodes);
    dataset_.points.resize(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        tags[i] = static_cast<std::uint64_t>(integer("a node tag"));
        dataset_.points[i] = point();
    }
    number_nodes(tags);
}

void GmshReader::read_nodes_4() {
    if (!dataset_.points.empty()) scanner_.fail("one section $Nodes", "a second one");
    const std::size_t blocks = count("the number of node blocks", 8, 20);
    const std::size_t nodes = count("the number of nodes", 8, 32);
    size("the smallest node tag");
    size("the largest node tag");
    std::vector<std::uint64_t> tags;
    tags.reserve(nodes);
    dataset_.points.reserve(nodes);
    for (std::size_t block = 0; block < blocks; ++block) {
        const int dim = dimension();
        integer("the tag of an entity");
        const int parameters = integer("whether the nodes are parametric") == 0 ? 0 : dim;
        const std::size_t in_block = count("the number of nodes of a block", 8, 32);
        if (in_block > nodes - tags.size()) {
            scanner_.fail("at most " + std::to_string(nodes - tags.size()) + " nodes more", std::to_string(in_block));
        }
        for (std::size_t i = 0; i < in_block; ++i)
            tags.push_back(size("a node tag"));
        for (std::size_t i = 0; i < in_block; ++i) {
            dataset_.points.push_back(point());
            for (int k = 0; k < parameters; ++k)
                real("a parameter of a node");
        }
    }
    if (tags.size() != nodes) scanner_.fail(std::to_string(nodes) + " nodes", std::to_string(tags.size()));
    number_nodes(tags);
}

GmshElementType GmshReader::element_type() {
    const std::int64_t number = integer("an element type");
    const std::optional<GmshElementType> type = gmsh_element_type(number);
    if (!type) {
        scanner_.fail("a known element type", std::to_string(number),
                      "polygons, polyhedra and orders above 4 cannot be read: write the mesh in first order");
    }
    return *type;
}

void GmshReader::read_element(const GmshElementType& type) {
    const std::size_t corners = type.kind ? vertex_count(*type.kind) : 0;
    const bool is_curved = subdivide_ > 0 && !type.places.empty();
    const std::size_t needed = is_curved ? static_cast<std::size_t>(type.nodes) : corners;
    element_nodes_.clear();
    for (std::size_t i = 0; i < static_cast<std::size_t>(type.nodes); ++i) {
        const std::uint64_t tag = version_2_ ? static_cast<std::uint64_t>(integer("a node tag")) : size("a node tag");
        if (i >= needed) continue;
        const std::optional<VertexId> node = nodes_.find(tag);
        if (!node) {
            scanner_.fail("the tag of one of the " + std::to_string(dataset_.points.size()) + " nodes",
                          std::to_string(tag), "nodes are missing or the tag is wrong: write it again",
                          ErrorKind::data);
        }
        element_nodes_.push_back(*node);
    }
    if (is_curved) curved_.add(dataset_.cells.size(), element_nodes_, type.places);
    if (type.kind) append_cell(dataset_.cells, *type.kind, std::span(element_nodes_).first(corners));
}

void GmshReader::add_labels(std::uint64_t tag, double physical, double entity) {
    cell_tags_.push_back(tag);
    physical_.values.push_back(physical);
    entity_.values.push_back(entity);
}

// Ascii: each element with its type. Binary: runs of elements of one type and number of labels.
void GmshReader::read_elements_2() {
    const std::size_t elements = scanner_.count("the number of elements", 8);
    scanner_.rest_of_line();
    for (std::size_t done = 0; done < elements;) {
        std::uint64_t tag = binary_ ? 0 : size("an element tag");
        const GmshElementType type = element_type();
        const std::int64_t run = binary_ ? integer("a number of elements") : 1;
        if (run < 0 || static_cast<std::uint64_t>(run) > elements - done) {
            scanner_.fail("at most " + std::to_string(elements - done) + " elements more", std::to_string(run));
        }
        const std::int64_t labels = integer("a number of labels");
        if (labels < 0) scanner_.fail("a number of labels, 0 or more", std::to_string(labels));
        for (std::int64_t i = 0; i < run; ++i, ++done) {
            if (binary_) tag = static_cast<std::uint64_t>(integer("an element tag"));
            std::array<double, 2> label{};  // physical group, entity; what follows are partitions
            for (std::int64_t k = 0; k < labels; ++k) {
                const auto value = static_cast<double>(std::abs(integer("a label of an element")));
                if (k < 2) label[static_cast<std::size_t>(k)] = value;
            }
            read_element(type);
            if (type.kind) add_labels(tag, label[0], label[1]);
            if (!type.kind) ++dataset_.skipped_cells;
        }
    }
}

void GmshReader::read_elements_4() {
    const std::size_t blocks = count("the number of element blocks", 8, 20);
    const std::size_t elements = count("the number of elements", 4, 16);
    size("the smallest element tag");
    size("the largest element tag");
    std::size_t done = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
        const int dim = dimension();
        const std::int64_t entity = integer("the tag of an entity");
        const GmshElementType type = element_type();
        const auto group = physical_groups_.find({dim, entity});
        const double physical = group == physical_groups_.end() ? 0.0 : group->second;
        const std::size_t in_block = count("the number of elements of a block", 4, 16);
        for (std::size_t i = 0; i < in_block; ++i) {
            const std::uint64_t tag = size("an element tag");
            read_element(type);
            if (type.kind) add_labels(tag, physical, static_cast<double>(entity));
        }
        done += in_block;
        if (!type.kind) dataset_.skipped_cells += in_block;
    }
    if (done != elements) scanner_.fail(std::to_string(elements) + " elements", std::to_string(done));
}

// ---- Views ----

Field& GmshReader::view_field(std::vector<Field>& fields, const std::string& name, int components, std::size_t rows) {
    const auto known = std::find_if(fields.begin(), fields.end(), [&](const Field& field) {
        return field.name == name && field.components == components;
    });
    if (known != fields.end()) return *known;  // parts of a view, from partitions
    const std::size_t values = rows * static_cast<std::size_t>(components);
    fields.push_back({name, components, std::vector<double>(values, std::numeric_limits<double>::quiet_NaN())});
    return fields.back();
}

// The tags in front of the values are ascii in all files.
void GmshReader::read_view(bool of_nodes) {
    const std::size_t strings = scanner_.count("a number of names", 1);
    scanner_.rest_of_line();
    std::string name = of_nodes ? "nodes" : "elements";
    for (std::size_t i = 0; i < strings; ++i) {
        std::string line(scanner_.rest_of_line());
        std::erase(line, '"');
        if (i == 0 && !line.empty()) name = line;
    }
    const std::size_t reals = scanner_.count("a number of reals", 2);
    for (std::size_t i = 0; i < reals; ++i)
        scanner_.number("a time");
    const std::size_t integers = scanner_.count("a number of integers", 2);
    if (integers < 3) scanner_.fail_word("3 integers or more: time step, components, values");
    const std::int64_t step = scanner_.integer("a time step");
    const std::int64_t components = scanner_.integer("a number of components");
    if (components != 1 && components != 3 && components != 9) scanner_.fail_word("1, 3 or 9 components");
    const auto width = static_cast<std::size_t>(components);
    const std::size_t rows = scanner_.count("a number of values", binary_ ? 4 + 8 * width : 2 + 2 * width);
    for (std::size_t i = 3; i < integers; ++i)
        scanner_.integer("a partition");
    scanner_.rest_of_line();
    if (step != 0) name += " step " + std::to_string(step);

    if (!of_nodes && !cells_) cells_ = GmshTags(cell_tags_);
    const GmshTags& places = of_nodes ? nodes_ : *cells_;
    std::vector<Field>& fields = of_nodes ? dataset_.point_fields : dataset_.cell_fields;
    const std::size_t total = of_nodes ? dataset_.points.size() : dataset_.cells.size();
    Field* field = nullptr;  // made by the first value on a volume cell or node: views of surfaces leave no field
    for (std::size_t i = 0; i < rows; ++i) {
        const auto place = places.find(static_cast<std::uint64_t>(integer("a tag")));
        std::array<double, 9> values{};
        for (std::size_t c = 0; c < width; ++c)
            values[c] = real("a value of a view");
        if (!place) continue;
        if (field == nullptr) field = &view_field(fields, name, static_cast<int>(components), total);
        std::copy_n(values.begin(), width, field->values.begin() + static_cast<std::ptrdiff_t>(*place * width));
    }
}

// ---- The whole ----

void GmshReader::finish() {
    const auto is_group = [](double group) { return group != 0.0; };
    if (std::any_of(physical_.values.begin(), physical_.values.end(), is_group)) {
        dataset_.cell_fields.push_back(std::move(physical_));
    }
    dataset_.cell_fields.push_back(std::move(entity_));
    require_volume_mesh(dataset_);
    subdivide_at_nodes(dataset_, curved_);
}

Dataset GmshReader::read() {
    read_format();
    while (!scanner_.at_end()) {
        const std::string name(scanner_.word("a section"));
        if (!name.starts_with('$') || name.starts_with("$End"))
            scanner_.fail_word("a section ($Nodes, $Elements, ...)");
        read_section(name);
    }
    if (!has_elements_) scanner_.fail("the section $Elements", "the end of the file", TextScanner::cut_off);
    finish();
    return std::move(dataset_);
}

}  // namespace

Dataset read_gmsh(const std::filesystem::path& file, int subdivide) {
    return GmshReader(file, subdivide).read();
}

}  // namespace cellproj
