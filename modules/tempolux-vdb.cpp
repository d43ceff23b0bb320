// modules/tempolux-vdb.cpp -- a child program that reads one density grid of each requested OpenVDB file and writes its
// voxels to standard output (lib/volume/vdb_pipe.h).
//
// A separate program, which lib/volume/vdb_file.cpp starts under limits of memory and time: damaged files can crash or
// hang OpenVDB 10, and loading it costs .06 s and 32 MB, which scenes without smoke should not pay. The program opens
// all files and calls guard_process() before it reads the first byte. openvdb::io::File would open files itself, so
// this program finds grids by their descriptors.
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <new>
#include <string>
#include <vector>

#include "lib/volume/vdb_pipe.h"
#include "modules/guard.h"

namespace {

using tempolux::VdbPipeHead;
using tempolux::VoxelBlock;

struct Refused {
  std::string words;
};

constexpr std::size_t kMostNames = 12;  ///< number of grids listed in a message
constexpr std::int32_t kMostGrids = 1024;

/// Refuses a file that is not a VDB with another message than a damaged one. The stream is at the beginning of the file
/// before and after.
void look_at_beginning(std::istream& file) {
  char bytes[12] = {};
  file.read(bytes, sizeof bytes);
  if (file.gcount() < 8 || std::string(bytes, 8) != std::string(" BDV\0\0\0\0", 8))
    throw Refused{"is not an OpenVDB file"};
  if (file.gcount() < 12) throw Refused{"is cut off"};
  std::uint32_t version = 0;
  std::copy(bytes + 8, bytes + 12, reinterpret_cast<char*>(&version));
  if (version < 213 || version > openvdb::OPENVDB_FILE_VERSION)
    throw Refused{"has file version " + std::to_string(version) + "; 213 to " +
                  std::to_string(openvdb::OPENVDB_FILE_VERSION) + " can be read, save it again with a newer program"};
  file.seekg(0);
}

std::string printable(std::string text, std::size_t most) {
  if (text.size() > most) text = text.substr(0, most) + "...";
  for (char& c : text)
    if ((unsigned char)c < 32 || c == 127) c = ' ';
  return text;
}

struct Candidate {
  openvdb::io::GridDescriptor place;  ///< where the grid lies in the file
  std::string name;
  openvdb::GridBase::Ptr metadata;  ///< the grid: complete, or its metadata alone
  bool is_number() const { return metadata->isType<openvdb::FloatGrid>() || metadata->isType<openvdb::DoubleGrid>(); }
  bool is_density() const {
    return is_number() &&
           (metadata->getGridClass() == openvdb::GRID_FOG_VOLUME || metadata->getGridClass() == openvdb::GRID_UNKNOWN);
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

/// Reads an open file as openvdb::io::File would.
class OpenFile : openvdb::io::Archive {
 public:
  explicit OpenFile(std::istream& file) : file_(file) {}

  /// All grids, sorted by name; metadata alone if the file has a table of offsets.
  std::vector<Candidate> grids() {
    readHeader(file_);
    metadata_->setSeekable(true);
    openvdb::io::setStreamMetadataPtr(file_, metadata_, false);
    setFormatVersion(file_);
    setLibraryVersion(file_);
    setDataCompression(file_);
    if (!inputHasGridOffsets()) return grids_in_sequence();
    openvdb::MetaMap().readMeta(file_);
    std::map<std::string, Candidate> found;
    const std::int32_t count = counted(readGridCount(file_));
    for (std::int32_t i = 0; i < count; ++i) {
      Candidate grid;
      grid.metadata = grid.place.read(file_);
      if (!grid.metadata || !file_) throw Refused{"has a grid without a description"};
      grid.name = grid.place.gridName();
      grid.place.seekToGrid(file_);
      readGridCompression(file_);
      grid.metadata->readMeta(file_);
      grid.place.seekToEnd(file_);
      found.emplace(grid.place.uniqueName(), std::move(grid));
    }
    std::vector<Candidate> grids;
    for (auto& [unique, grid] : found) grids.push_back(std::move(grid));
    return grids;
  }

  /// Reads the whole grid. An instance gets the voxels of the grid that it refers to.
  openvdb::GridBase::Ptr whole(const Candidate& grid, const std::vector<Candidate>& all) {
    if (!inputHasGridOffsets()) return grid.metadata;
    const openvdb::GridBase::Ptr loaded = voxels_of(grid.place);
    if (!grid.place.isInstance()) return loaded;
    for (const Candidate& parent : all) {
      if (parent.place.uniqueName() != grid.place.instanceParentName()) continue;
      const openvdb::GridBase::Ptr other = voxels_of(parent.place);
      if (parent.place.isInstance() || other->type() != loaded->type()) break;
      loaded->setTree(other->baseTreePtr());
      return loaded;
    }
    throw Refused{"has a grid that shares the voxels of another one that is not there"};
  }

 private:
  static std::int32_t counted(std::int32_t count) {
    if (count > kMostGrids) throw Refused{"has more than 1024 grids"};
    if (count <= 0) throw Refused{"has no grid"};
    return count;
  }

  /// Reads all grids of a file that was written to a pipe, one after the other.
  std::vector<Candidate> grids_in_sequence() {
    file_.clear();
    file_.seekg(0);
    const openvdb::GridPtrVecPtr read = openvdb::io::Stream(file_, false).getGrids();
    counted(read ? std::int32_t(std::min<std::size_t>(read->size(), kMostGrids + 1)) : 0);
    std::vector<Candidate> grids;
    for (const openvdb::GridBase::Ptr& grid : *read) grids.push_back({{}, grid->getName(), grid});
    return grids;
  }

  openvdb::GridBase::Ptr voxels_of(const openvdb::io::GridDescriptor& place) {
    const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(place.gridType());
    if (place.saveFloatAsHalf()) grid->setSaveFloatAsHalf(true);
    place.seekToGrid(file_);
    readGrid(grid, place, file_);
    return grid;
  }

  std::istream& file_;
  /// the stream refers to this object
  openvdb::io::StreamMetadata::Ptr metadata_ = std::make_shared<openvdb::io::StreamMetadata>();
};

/// The grid to read: by name, else "density", else the only density grid.
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
    throw Refused{"has no grid " +
                  (wanted.empty() ? "density and no other that could be one" : "'" + printable(name, 40) + "'") +
                  "; it has " + listed(grids)};
  if (number >= long(found.size()))
    throw Refused{"has " + std::to_string(found.size()) + " grids '" + printable(name, 40) + "'"};
  if (found.size() > 1 && number < 0)
    throw Refused{"has several grids that could be meant: " + listed(grids) +
                  "; choose one by NAME, or NAME:0, NAME:1 of equal names"};
  const Candidate& grid = *found[std::size_t(std::max(0L, number))];
  if (!grid.is_density())
    throw Refused{"grid '" + printable(grid.name, 40) + "' is not a density but " + printable(grid.kind(), 60) +
                  "; choose from " + listed(grids)};
  return grid;
}

std::array<double, 12> affine_of(const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) throw Refused{"its grid is bent (a frustum); resample it to a box"};
  const auto m = transform.baseMap()->getAffineMap()->getMat4();  // for row vectors
  std::array<double, 12> rows{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows[std::size_t(4 * r + c)] = m(c, r);
  for (const double v : rows)
    if (!std::isfinite(v)) throw Refused{"its transform is not finite"};
  return rows;
}

void check(double value, const openvdb::Coord& at) {
  if (value >= 0 && value <= 3e38) return;
  throw Refused{"voxel (" + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()) +
                ") is " + std::to_string(value) + ": a density is finite and not negative"};
}

/// Converts tiles (blocks with a single value) other than 0 into voxels.
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
  if (tree.background() != 0)
    throw Refused{"its density is not 0 outside its voxels (background " + std::to_string(tree.background()) + ")"};
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
    for (openvdb::Index i = 0; i < 512; ++i) {  // reads stored values, active or not
      check(double(leaf->getValue(i)), leaf->offsetToGlobalCoord(i));
      block.values[i] = float(leaf->getValue(i));
    }
    std::fwrite(&block, sizeof block, 1, stdout);
  }
  if (std::fflush(stdout) != 0) throw Refused{"its voxels could not be handed over"};
}

struct Request {
  std::string path, grid;
  std::ifstream file;
};

/// Reads all requests and opens their files without reading them.
std::vector<Request> open_all() {
  std::vector<Request> requests;
  for (std::string path, grid; std::getline(std::cin, path) && std::getline(std::cin, grid);)
    requests.push_back({path, grid, std::ifstream(path, std::ios::binary)});
  return requests;
}

void read(Request& request) {
  if (!request.file) throw Refused{"cannot be opened"};
  look_at_beginning(request.file);
  OpenFile file(request.file);
  const std::vector<Candidate> grids = file.grids();
  const Candidate& grid = chosen(grids, request.grid);
  const openvdb::GridBase::Ptr loaded = file.whole(grid, grids);
  if (auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(loaded)) print(*floats, grid.name);
  else if (auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(loaded)) print(*doubles, grid.name);
  else throw Refused{"its grid could not be read"};
}

/// Triggers what OpenVDB and TBB do at first use: they register types, read the number of processors and open other
/// libraries.
void warm_up() {
  openvdb::initialize();
  tbb::parallel_for(0, 2, [](int) {});
}

void run() {
  warm_up();
  std::vector<Request> requests = open_all();
  if (const std::string trouble = tempolux::guard_process(); !trouble.empty()) throw Refused{trouble};
  for (Request& request : requests) read(request);
}

}  // namespace

int main() {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism,
                                       1);  // a guarded process cannot start threads
  std::string words;
  try {
    run();
    std::_Exit(0);  // at a regular exit TBB would start threads
  } catch (const Refused& refused) { words = refused.words; } catch (const std::bad_alloc&) {
    words = "does not fit the memory it may use; raise --max-memory, or resample it coarser";
  } catch (const std::exception& error) {
    words = "OpenVDB cannot read it: " + printable(error.what(), 300) + "; is it whole?";
  }
  std::fprintf(stderr, "%s\n", words.c_str());
  std::_Exit(2);
}
