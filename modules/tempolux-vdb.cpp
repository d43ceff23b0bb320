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
  bool is_float() const { return metadata->isType<openvdb::FloatGrid>() || metadata->isType<openvdb::DoubleGrid>(); }
  bool is_integer() const {
    return metadata->isType<openvdb::Int32Grid>() || metadata->isType<openvdb::Int64Grid>() ||
           metadata->isType<openvdb::BoolGrid>();
  }
  bool is_number() const { return is_float() || is_integer(); }
  bool is_level_set() const { return is_number() && metadata->getGridClass() == openvdb::GRID_LEVEL_SET; }
  bool is_density() const {
    return is_number() &&
           (metadata->getGridClass() == openvdb::GRID_FOG_VOLUME || metadata->getGridClass() == openvdb::GRID_UNKNOWN);
  }
  std::string kind() const {
    return is_float() ? openvdb::GridBase::gridClassToString(metadata->getGridClass()) : metadata->type();
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

/// Why a grid is refused, with what to do: the file's densities, or else how to make one.
std::string why_no_density(const Candidate& grid, const std::vector<Candidate>& all) {
  std::string text = "grid '" + printable(grid.name, 40) + "' is not a density but " +
                     (grid.is_level_set() ? "a level set (distances from a surface)" : printable(grid.kind(), 60));
  std::vector<Candidate> densities;
  for (const Candidate& other : all)
    if (other.is_density()) densities.push_back(other);
  if (!densities.empty()) return text + "; choose from " + listed(densities);
  return text +
         (grid.is_level_set()
              ? "; convert it to a fog volume (Houdini: Convert VDB; openvdb: tools::sdfToFogVolume) or export its "
                "surface as a mesh"
              : "; save the density as a grid of floats");
}

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
  for (const bool integer : {false, true})
    if (found.empty() && wanted.empty())
      for (const Candidate& grid : grids)
        if (grid.is_density() && grid.is_integer() == integer) found.push_back(&grid);
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
  if (!grid.is_density()) throw Refused{why_no_density(grid, grids)};
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

/// Counts values that are no density; 0 replaces them.
class Values {
 public:
  explicit Values(std::string grid) : grid_(std::move(grid)) {}

  static bool is_density(double value) { return value >= 0 && value <= 3e38; }

  /// Counts a value of `voxels` voxels, the first of them at `at`.
  void count(double value, const openvdb::Coord& at, double voxels = 1) {
    if (value != 0) ++values_;
    if (is_density(value)) {
      sum_ += value * voxels;
      return;
    }
    if (invalid_++ == 0) first_ = at, first_value_ = value;
    lowest_ = std::min(lowest_, value);
    if (value < 0 && value >= -3e38) negative_ -= value * voxels;
    else ++not_finite_;
  }

  /// What was replaced; "": nothing. Refuses a grid with so many invalid values that it is another quantity.
  std::string note() const {
    if (invalid_ == 0) return "";
    const std::string first = "voxel (" + std::to_string(first_.x()) + ", " + std::to_string(first_.y()) + ", " +
                              std::to_string(first_.z()) + ") is " + number(first_value_);
    if (negative_ > kMostInvalid * sum_ || not_finite_ > kMostInvalid * values_)
      throw Refused{first + ": a density is finite and not negative; " + number(invalid_) + " of " + number(values_) +
                    " values are invalid, so '" + grid_ + "' is another quantity, or damaged"};
    return "grid '" + grid_ + "': " + first +
           (invalid_ > 1 ? " and " + number(invalid_ - 1) + " more are invalid" : "") +
           "; a density is finite and not negative, so 0 replaces " + (invalid_ > 1 ? "them" : "it") +
           (not_finite_ == 0 && invalid_ > 1 ? " (the lowest is " + number(lowest_) + ")" : "");
  }

 private:
  /// Largest share of the values, or of their sum, that may be invalid.
  static constexpr double kMostInvalid = 0.01;

  static std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
  }

  std::string grid_;
  openvdb::Coord first_;
  double first_value_ = 0, lowest_ = 0, sum_ = 0, negative_ = 0;
  double values_ = 0, invalid_ = 0, not_finite_ = 0;
};

/// Converts tiles (blocks with a single value) other than 0 into voxels.
template <class Tree>
void expand_tiles(Tree& tree, Values& values) {
  std::vector<std::pair<openvdb::CoordBBox, typename Tree::ValueType>> tiles;
  double voxels = 0;
  auto it = tree.cbeginValueAll();
  it.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; it; ++it) {
    if (it.getValue() == 0) continue;
    openvdb::CoordBBox box;
    it.getBoundingBox(box);
    // A valid value is counted with the leaves, which the tile becomes.
    if (const double value = double(it.getValue()); !Values::is_density(value)) {
      values.count(value, it.getCoord(), double(box.volume()));
      tiles.emplace_back(box, typename Tree::ValueType(0));
      continue;
    }
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
    throw Refused{"its density is not 0 outside its voxels (background " + std::to_string(double(tree.background())) +
                  ")"};
  Values values(printable(name, 40));
  expand_tiles(tree, values);
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
  for (const auto* leaf : leaves)
    for (openvdb::Index i = 0; i < 512; ++i)  // reads stored values, active or not
      values.count(double(leaf->getValue(i)), leaf->offsetToGlobalCoord(i));
  const std::string note = values.note();
  head.note_size = note.size();
  std::fwrite(&head, sizeof head, 1, stdout);
  std::fwrite(name.data(), 1, name.size(), stdout);
  std::fwrite(note.data(), 1, note.size(), stdout);
  for (const auto* leaf : leaves) {
    VoxelBlock block;
    block.origin = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
    for (openvdb::Index i = 0; i < 512; ++i)
      block.values[i] = Values::is_density(double(leaf->getValue(i))) ? float(leaf->getValue(i)) : 0.0f;
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
  else if (auto ints = openvdb::gridPtrCast<openvdb::Int32Grid>(loaded)) print(*ints, grid.name);
  else if (auto longs = openvdb::gridPtrCast<openvdb::Int64Grid>(loaded)) print(*longs, grid.name);
  else if (auto flags = openvdb::gridPtrCast<openvdb::BoolGrid>(loaded)) print(*flags, grid.name);
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
