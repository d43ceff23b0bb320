// make-vdb -- write an OpenVDB file from plain voxels, for tests and for scenes made by scripts.
//
//     make-vdb OUT.vdb NX NY NZ VOXEL X Y Z [NAME [fog|level-set|unknown [BACKGROUND [float|half|double|vector]]]]  < VALUES
//
// VALUES: NX NY NZ numbers of float32, z fastest. Voxel (0, 0, 0) has its centre at (X, Y, Z) in metres, voxels are VOXEL m apart. Zeros are
// left out. An existing file gets the grid as one more.
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
typename Grid::Ptr make(const std::vector<float>& values, const std::array<int, 3>& size, typename Grid::ValueType background, float zero) {
  auto grid = Grid::create(background);
  auto accessor = grid->getAccessor();
  std::size_t i = 0;
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z, ++i)
        if (values[i] != zero) accessor.setValue({x, y, z}, typename Grid::ValueType(values[i]));
  return grid;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 9) return std::fprintf(stderr, "make-vdb OUT NX NY NZ VOXEL X Y Z [NAME [CLASS [BACKGROUND [TYPE]]]] < VALUES\n"), 2;
  const std::array<int, 3> size{std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4])};
  const std::string name = argc > 9 ? argv[9] : "density", kind = argc > 10 ? argv[10] : "fog", type = argc > 12 ? argv[12] : "float";
  const double voxel = std::atof(argv[5]), background = argc > 11 ? std::atof(argv[11]) : 0;
  const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
  std::vector<float> values(count);
  if (std::fread(values.data(), sizeof(float), values.size(), stdin) != values.size())
    return std::fprintf(stderr, "make-vdb: fewer values than voxels\n"), 2;
  openvdb::initialize();
  openvdb::GridBase::Ptr grid;
  if (type == "double") grid = make<openvdb::DoubleGrid>(values, size, background, 0);
  else if (type == "vector") grid = make<openvdb::Vec3SGrid>(values, size, openvdb::Vec3f(0.0f), 0);
  else grid = make<openvdb::FloatGrid>(values, size, float(background), 0);
  grid->setSaveFloatAsHalf(type == "half");
  grid->setName(name);
  grid->setGridClass(kind == "fog" ? openvdb::GRID_FOG_VOLUME : kind == "level-set" ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN);
  auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({std::atof(argv[6]), std::atof(argv[7]), std::atof(argv[8])});
  grid->setTransform(transform);
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
