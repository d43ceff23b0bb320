// make-vdb -- writes an OpenVDB file from plain voxels, for tests and for scenes made by scripts.
//
//     make-vdb OUT.vdb NX NY NZ VOXEL X Y Z [NAME [CLASS [BACKGROUND [TYPE [FIRST [M]]]]]]  < VALUES
//
// VALUES: NX NY NZ numbers of float32, z fastest; zeros are left out. X, Y, Z: centre of the first voxel, m. VOXEL:
// edge of a voxel, m. CLASS: fog, level-set or unknown. TYPE: float, half, double, int32, int64, bool or vector; or
// tiles, which stores uniform blocks as one value. FIRST: x, y and z of the first voxel in index space (0). M: three
// rows of three numbers in place of VOXEL, the metres along each world axis for a step along each axis of index space.
// If OUT.vdb exists, the grid is added to it.
#include <openvdb/openvdb.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

template <class Grid>
typename Grid::Ptr make(const std::vector<float>& values, const std::array<int, 3>& size,
                        typename Grid::ValueType background, int first) {
  auto grid = Grid::create(background);
  auto accessor = grid->getAccessor();
  std::size_t i = 0;
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z, ++i)
        if (values[i] != 0) accessor.setValue({first + x, first + y, first + z}, typename Grid::ValueType(values[i]));
  return grid;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 9)
    return std::fprintf(stderr,
                        "make-vdb OUT NX NY NZ VOXEL X Y Z [NAME [CLASS [BACKGROUND [TYPE [FIRST [M]]]]]] < VALUES\n"),
           2;
  const std::array<int, 3> size{std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4])};
  const std::string name = argc > 9 ? argv[9] : "density", kind = argc > 10 ? argv[10] : "fog",
                    type = argc > 12 ? argv[12] : "float";
  const double voxel = std::atof(argv[5]), background = argc > 11 ? std::atof(argv[11]) : 0;
  const int first = argc > 13 ? std::atoi(argv[13]) : 0;
  const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
  std::vector<float> values(count);
  if (std::fread(values.data(), sizeof(float), values.size(), stdin) != values.size())
    return std::fprintf(stderr, "make-vdb: fewer values than voxels\n"), 2;
  openvdb::initialize();
  openvdb::GridBase::Ptr grid;
  if (type == "double") grid = make<openvdb::DoubleGrid>(values, size, background, first);
  else if (type == "vector") grid = make<openvdb::Vec3SGrid>(values, size, openvdb::Vec3f(0.0f), first);
  else if (type == "int32") grid = make<openvdb::Int32Grid>(values, size, 0, first);
  else if (type == "int64") grid = make<openvdb::Int64Grid>(values, size, 0, first);
  else if (type == "bool") grid = make<openvdb::BoolGrid>(values, size, false, first);
  else grid = make<openvdb::FloatGrid>(values, size, float(background), first);
  grid->setSaveFloatAsHalf(type == "half");
  grid->setName(name);
  grid->setGridClass(kind == "fog"         ? openvdb::GRID_FOG_VOLUME
                     : kind == "level-set" ? openvdb::GRID_LEVEL_SET
                                           : openvdb::GRID_UNKNOWN);
  if (type == "tiles") grid->pruneGrid();
  openvdb::Mat4d place = openvdb::Mat4d::identity();  // for row vectors
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) place(c, r) = argc > 22 ? std::atof(argv[14 + 3 * r + c]) : r == c ? voxel : 0;
  const openvdb::Vec3d moved = place.transform3x3(openvdb::Vec3d(first));
  for (int a = 0; a < 3; ++a) place(3, a) = std::atof(argv[6 + a]) - moved[a];
  grid->setTransform(openvdb::math::Transform::createLinearTransform(place));
  openvdb::GridPtrVec grids;
  if (std::filesystem::exists(argv[1])) {
    openvdb::io::File file(argv[1]);
    file.open(false);
    grids = *file.getGrids();
  }
  grids.push_back(grid);
  openvdb::io::File(argv[1]).write(grids);
  return 0;
}
