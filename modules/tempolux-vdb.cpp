// tempolux-vdb -- reads one density of each OpenVDB file that it is asked for and prints its voxels: lib/volume/vdb_pipe.h.
//
// A program of its own, started by lib/volume/vdb_file.cpp under limits of memory and time: damaged files crash or hang
// OpenVDB 10, and starting with it costs .06 s and 32 MB that scenes without smoke need not pay.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <new>
#include <string>
#include <vector>

#include "lib/volume/vdb_pipe.h"

namespace {

using tempolux::VdbPipeHead;
using tempolux::VoxelBlock;

struct Refused {
  std::string words;
};

constexpr std::size_t kMostNames = 12;   ///< of grids, in a message
constexpr std::int32_t kMostGrids = 1024;

/// Reads the file up to its first descriptor, so that what is no VDB is told apart from what is damaged.
void look_at_beginning(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Refused{"cannot be opened"};
  char bytes[12] = {};
  file.read(bytes, sizeof bytes);
  if (file.gcount() < 8 || std::string(bytes, 8) != std::string(" BDV\0\0\0\0", 8))
    throw Refused{"is not an OpenVDB file"};
  if (file.gcount() < 12) throw Refused{"is cut off"};
  std::uint32_t version = 0;
  std::copy(bytes + 8, bytes + 12, reinterpret_cast<char*>(&version));
  if (version < 213 || version > openvdb::OPENVDB_FILE_VERSION)
    throw Refused{"has file version " + std::to_string(version) + "; 213 to " + std::to_string(openvdb::OPENVDB_FILE_VERSION) +
                  " can be read, save it again with a newer program"};
}

std::string printable(std::string text, std::size_t most) {
  if (text.size() > most) text = text.substr(0, most) + "...";
  for (char& c : text)
    if ((unsigned char)c < 32 || c == 127) c = ' ';
  return text;
}

struct Candidate {
  std::string unique, name;                  ///< as OpenVDB tells grids of one name apart: "density[1]"
  openvdb::GridBase::Ptr metadata;
  bool is_number() const {
    return metadata->isType<openvdb::FloatGrid>() || metadata->isType<openvdb::DoubleGrid>();
  }
  bool is_density() const {
    return is_number() && (metadata->getGridClass() == openvdb::GRID_FOG_VOLUME || metadata->getGridClass() == openvdb::GRID_UNKNOWN);
  }
  std::string kind() const {
    return is_number() ? openvdb::GridBase::gridClassToString(metadata->getGridClass()) : metadata->type();
  }
};

std::string listed(const std::vector<Candidate>& grids) {
  std::string text;
  for (std::size_t i = 0; i < grids.size() && i < kMostNames; ++i)
    text += (i ? ", " : "") + printable(grids[i].name, 40) + " (" + printable(grids[i].kind(), 60) + ")";
  return text + (grids.size() > kMostNames ? ", ..." : "");
}

std::vector<Candidate> all_grids(openvdb::io::File& file) {
  std::vector<Candidate> grids;
  for (auto name = file.beginName(); name != file.endName(); ++name) {
    if (grids.size() == std::size_t(kMostGrids)) throw Refused{"has more than 1024 grids"};
    const std::string unique = *name;
    const std::size_t bracket = unique.rfind('[');
    const bool numbered = bracket != std::string::npos && bracket > 0 && unique.back() == ']';
    grids.push_back({unique, numbered ? unique.substr(0, bracket) : unique, file.readGridMetadata(unique)});
    if (!grids.back().metadata) throw Refused{"has a grid without a description"};
  }
  if (grids.empty()) throw Refused{"has no grid"};
  return grids;
}

/// The one to read: by name, else "density", else the only density.
const Candidate& chosen(const std::vector<Candidate>& grids, const std::string& wanted) {
  std::string name = wanted.empty() ? "density" : wanted;
  long number = -1;
  const std::size_t colon = wanted.rfind(':');
  if (colon != std::string::npos && colon + 1 < wanted.size() &&
      wanted.find_first_not_of("0123456789", colon + 1) == std::string::npos && wanted.size() - colon < 6) {
    name = wanted.substr(0, colon);
    number = std::stol(wanted.substr(colon + 1));
  }
  std::vector<const Candidate*> found;
  for (const Candidate& grid : grids)
    if (grid.name == name) found.push_back(&grid);
  if (found.empty() && wanted.empty())
    for (const Candidate& grid : grids)
      if (grid.is_density()) found.push_back(&grid);
  if (found.empty() && wanted.empty() && grids.size() == 1) found.push_back(&grids.front());
  if (found.empty())
    throw Refused{"has no grid " + (wanted.empty() ? "density and no other that could be one" : "'" + printable(name, 40) + "'") +
                  "; it has " + listed(grids)};
  if (number >= long(found.size())) throw Refused{"has " + std::to_string(found.size()) + " grids '" + printable(name, 40) + "'"};
  if (found.size() > 1 && number < 0)
    throw Refused{"has several grids that could be meant: " + listed(grids) + "; choose one by NAME, or NAME:0, NAME:1 of equal names"};
  const Candidate& grid = *found[std::size_t(std::max(0L, number))];
  if (!grid.is_density())
    throw Refused{"grid '" + printable(grid.name, 40) + "' is not a density but " + printable(grid.kind(), 60) + "; choose from " +
                  listed(grids)};
  return grid;
}

std::array<double, 12> affine_of(const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) throw Refused{"its grid is bent (a frustum); resample it to a box"};
  const auto m = transform.baseMap()->getAffineMap()->getMat4();   // of row vectors
  std::array<double, 12> rows{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows[std::size_t(4 * r + c)] = m(c, r);
  for (const double v : rows)
    if (!std::isfinite(v)) throw Refused{"its transform is not finite"};
  return rows;
}

void check(double value, const openvdb::Coord& at) {
  if (value >= 0 && value <= 3e38) return;
  throw Refused{"voxel (" + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()) + ") is " +
                std::to_string(value) + ": a density is finite and not negative"};
}

/// Tiles (blocks of one value) that are not 0 become voxels.
template <class Tree>
void expand_tiles(Tree& tree) {
  std::vector<std::pair<openvdb::CoordBBox, typename Tree::ValueType>> tiles;
  double voxels = 0;
  auto it = tree.cbeginValueAll();
  it.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; it; ++it) {
    if (it.getValue() == 0) continue;
    check(double(it.getValue()), it.getCoord());
    openvdb::CoordBBox box;
    it.getBoundingBox(box);
    voxels += double(box.volume());
    if (voxels > 4e9) throw Refused{"has constant regions of more than 4e9 voxels; resample it coarser"};
    tiles.emplace_back(box, it.getValue());
  }
  for (const auto& [box, value] : tiles) tree.denseFill(box, value, true);
}

template <class Grid>
void print(Grid& grid, const std::string& name) {
  auto& tree = grid.tree();
  if (tree.background() != 0) throw Refused{"its density is not 0 outside its voxels (background " + std::to_string(tree.background()) + ")"};
  expand_tiles(tree);
  VdbPipeHead head;
  head.world_from_index = affine_of(grid.transform());
  head.name_size = name.size();
  std::vector<typename Grid::TreeType::LeafNodeType*> leaves;
  tree.getNodes(leaves);
  std::erase_if(leaves, [](const auto* leaf) {
    for (openvdb::Index i = 0; i < 512; ++i)
      if (leaf->getValue(i) != 0) return false;
    return true;
  });
  head.block_count = leaves.size();
  std::fwrite(&head, sizeof head, 1, stdout);
  std::fwrite(name.data(), 1, name.size(), stdout);
  for (const auto* leaf : leaves) {
    VoxelBlock block;
    block.origin = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
    for (openvdb::Index i = 0; i < 512; ++i) {   // active or not: what is stored is what is read
      check(double(leaf->getValue(i)), leaf->offsetToGlobalCoord(i));
      block.values[i] = float(leaf->getValue(i));
    }
    std::fwrite(&block, sizeof block, 1, stdout);
  }
  if (std::fflush(stdout) != 0) throw Refused{"its voxels could not be handed over"};
}

void read(const std::string& path, const std::string& wanted) {
  look_at_beginning(path);
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(false);                          // not by and by, from a mapped file
  const std::vector<Candidate> grids = all_grids(file);
  const Candidate& grid = chosen(grids, wanted);
  const openvdb::GridBase::Ptr loaded = file.readGrid(grid.unique);
  if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(loaded)) print(*floats, grid.name);
  else if (auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(loaded)) print(*doubles, grid.name);
  else throw Refused{"its grid could not be read"};
}

/// Standard input, whole, as a file on standard output.
void write() {
  tempolux::VdbWriteHead head;
  const auto take = [](void* to, std::size_t size) {
    if (std::fread(to, 1, size, stdin) != size) throw Refused{"was given less than it was promised"};
  };
  take(&head, sizeof head);
  if (head.magic != tempolux::VdbWriteHead{}.magic || head.name_size > 256) throw Refused{"is of another version than its caller"};
  std::string name(head.name_size, ' ');
  take(name.data(), name.size());
  openvdb::initialize();
  auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3s(0.0f));
  grid->setName(name);
  openvdb::Mat4d place = openvdb::Mat4d::identity();   // of row vectors
  for (int a = 0; a < 3; ++a) {
    place(a, a) = head.voxel[std::size_t(a)];
    place(3, a) = head.first_centre[std::size_t(a)];
  }
  grid->setTransform(openvdb::math::Transform::createLinearTransform(place));
  auto accessor = grid->getAccessor();
  for (std::int32_t x = 0; x < head.counts[0]; ++x)
    for (std::int32_t y = 0; y < head.counts[1]; ++y)
      for (std::int32_t z = 0; z < head.counts[2]; ++z) {
        float rgb[3];
        take(rgb, sizeof rgb);
        if (rgb[0] != 0 || rgb[1] != 0 || rgb[2] != 0) accessor.setValue({x, y, z}, openvdb::Vec3s(rgb[0], rgb[1], rgb[2]));
      }
  openvdb::io::Stream(std::cout).write(openvdb::GridCPtrVec{grid});
  if (!std::cout.flush()) throw Refused{"could not hand over the file"};
}

}  // namespace

int main(int argc, char** argv) {
  std::string path, grid, words;
  try {
    if (argc > 1 && std::string(argv[1]) == "write") return write(), 0;
    while (std::getline(std::cin, path) && std::getline(std::cin, grid)) read(path, grid);
    return 0;
  } catch (const Refused& refused) {
    words = refused.words;
  } catch (const std::bad_alloc&) {
    words = "does not fit the memory it may use; raise --max-memory, or resample it coarser";
  } catch (const std::exception& error) {
    words = "OpenVDB cannot read it: " + printable(error.what(), 300) + "; is it whole?";
  }
  std::fprintf(stderr, "%s\n", words.c_str());
  return 2;
}
