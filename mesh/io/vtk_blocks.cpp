// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCell.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSet.h>
#include <vtkGenericCell.h>
#include <vtkInformation.h>
#include <vtkMultiPieceDataSet.h>
#include <vtkPartitionedDataSet.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/merge_blocks.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

struct Leaf {
    std::string name;  // its path in the tree
    vtkDataSet* data;
    bool volume = false;  // to be asked once: conversion empties it
};

// Pieces of one dataset (what a partitioned file or a parallel run makes of it) share the name of the whole.
bool are_pieces(const vtkDataObjectTree& tree) {
    return dynamic_cast<const vtkPartitionedDataSet*>(&tree) || dynamic_cast<const vtkMultiPieceDataSet*>(&tree);
}

// Names from binary files are filled up with blanks.
std::string without_padding(std::string text) {
    text.erase(text.find_last_not_of(" \t\r\n") + 1);
    return text;
}

bool is_volume_type(int vtk_type) {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(vtk_type));
    return cell && cell->GetCellDimension() == 3;
}

// Whether there is anything to draw in it. Cells of unknown types count: `to_dataset` refuses them by name.
bool is_volume(vtkDataSet& data) {
    if (is_structured(data)) return data.GetNumberOfCells() > 0 && data.GetMaxCellSize() >= 8;
    auto* grid = vtkUnstructuredGrid::SafeDownCast(&data);
    vtkUnsignedCharArray* types = grid ? grid->GetCellTypesArray() : nullptr;
    if (!types) return false;
    std::array<bool, 256> present{};
    for (vtkIdType c = 0; c < types->GetNumberOfValues(); ++c)
        present[types->GetValue(c)] = true;
    for (int type = 0; type < 256; ++type) {
        if (present[static_cast<std::size_t>(type)] && is_volume_type(type)) return true;
    }
    return false;
}

void collect_leaves(vtkDataObject* data, const std::string& name, std::vector<Leaf>& leaves) {
    if (auto* leaf = vtkDataSet::SafeDownCast(data)) leaves.push_back({name, leaf, is_volume(*leaf)});
    auto* tree = vtkDataObjectTree::SafeDownCast(data);
    if (!tree) return;
    const auto children = vtkSmartPointer<vtkDataObjectTreeIterator>::Take(tree->NewTreeIterator());
    children->TraverseSubTreeOff();
    children->VisitOnlyLeavesOff();
    children->SkipEmptyNodesOff();
    std::size_t number = 0;
    for (children->InitTraversal(); !children->IsDoneWithTraversal(); children->GoToNextItem(), ++number) {
        const char* label =
            children->HasCurrentMetaData() ? children->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME()) : nullptr;
        std::string own = without_padding(label ? label : "");
        if (own.empty()) own = "block " + std::to_string(number);
        if (are_pieces(*tree) && !name.empty()) own.clear();
        const bool nested = !name.empty() && !own.empty();
        collect_leaves(children->GetCurrentDataObject(), nested ? name + "/" + own : name + own, leaves);
    }
}

Dataset leaf_to_dataset(vtkDataSet& data, const fs::path& place, const std::string& format, int subdivide) {
    if (is_structured(data)) return structured_to_dataset(data, place, format);
    if (auto* grid = vtkUnstructuredGrid::SafeDownCast(&data)) return to_dataset(*grid, place, format, subdivide);
    throw Error({.kind = ErrorKind::data,
                 .place = place.string(),
                 .expected = "volume cells",
                 .found = std::string("a dataset of VTK's class ") + data.GetClassName(),
                 .advice = "fill a closed surface with tetrahedra first: cellproj tetrahedralize"});
}

void add_name(std::vector<std::string>& names, const std::string& name) {
    for (const std::string& known : names) {
        if (known == name) return;
    }
    names.push_back(name);
}

}  // namespace

Dataset blocks_to_dataset(vtkDataObject& data, const fs::path& file, const std::string& format,
                          const ReadOptions& options) {
    const std::vector<std::string>& wanted = options.blocks;
    if (auto* single = vtkDataSet::SafeDownCast(&data))
        return leaf_to_dataset(*single, file, format, options.subdivide);
    if (!vtkDataObjectTree::SafeDownCast(&data)) {
        throw Error({.kind = ErrorKind::data,
                     .place = file.string(),
                     .expected = "a mesh or blocks of meshes",
                     .found = std::string("data of VTK's class ") + data.GetClassName(),
                     .advice = "convert it to a .vtu file"});
    }
    std::vector<Leaf> leaves;
    collect_leaves(&data, "", leaves);
    std::vector<std::string> names;
    std::size_t skipped_blocks = 0;
    std::size_t skipped_cells = 0;
    for (const Leaf& leaf : leaves) {
        if (leaf.volume) {
            add_name(names, leaf.name);
        } else {
            ++skipped_blocks;
            skipped_cells += static_cast<std::size_t>(leaf.data->GetNumberOfCells());
        }
    }
    if (names.empty()) {
        throw Error({.kind = ErrorKind::data,
                     .place = file.string(),
                     .expected = "a block of volume cells",
                     .found = "none among " + std::to_string(leaves.size()) + " blocks",
                     .advice = "fill a closed surface with tetrahedra first: cellproj tetrahedralize"});
    }
    require_known_blocks(wanted, names, file);
    std::vector<Dataset> blocks;
    for (const Leaf& leaf : leaves) {
        if (!leaf.volume || !is_chosen(leaf.name, wanted)) continue;
        blocks.push_back(
            leaf_to_dataset(*leaf.data, file.string() + ", block " + leaf.name, format, options.subdivide));
        blocks.back().source = file.string();
    }
    Dataset dataset = merge_blocks(std::move(blocks), file);
    dataset.blocks = std::move(names);
    dataset.skipped_blocks = skipped_blocks;
    dataset.skipped_cells += skipped_cells;
    return dataset;
}

}  // namespace cellproj
