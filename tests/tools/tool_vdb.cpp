/* tool_vdb.cpp - OpenVDB files for the tests of import-vdb, and what OpenVDB reads back of them.
 *
 *   tool_vdb make FOLDER                          write the files
 *   tool_vdb sparse FILE N PERCENT                N^3 voxels, so many of a hundred active: a fog
 *                                                 of balls
 *   tool_vdb dump FILE GRID COMPONENT [BOX...]    standard output: a line of the lower corner and
 *                                                 the sizes, a line of sixteen numbers of the map,
 *                                                 then the samples, voxel by voxel; BOX: six
 *                                                 numbers, default: of what is active
 */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

using namespace openvdb;

/* ---- making ---- */

static uint32_t mixed(int i, int j, int k) {
    uint32_t h = uint32_t(i) * 2654435761u ^ uint32_t(j) * 2246822519u ^ uint32_t(k) * 3266489917u;
    h ^= h >> 15;
    h *= 2246822519u;
    return h ^ h >> 13;
}

template <typename V> V value(uint32_t h) {
    return V(int32_t(h) >> 12);
}
template <> float value<float>(uint32_t h) {
    return float(int32_t(h)) / 65536.0f;
}
template <> double value<double>(uint32_t h) {
    return int32_t(h) / 3.0;
}
template <> int64_t value<int64_t>(uint32_t h) {
    return int64_t(int32_t(h)) << 20;
}
template <> bool value<bool>(uint32_t h) {
    return h & 1;
}
template <> Vec3s value<Vec3s>(uint32_t h) {
    return Vec3s(value<float>(h), value<float>(h * 3), value<float>(h * 7));
}
template <> Vec3d value<Vec3d>(uint32_t h) {
    return Vec3d(value<double>(h), value<double>(h * 3), value<double>(h * 7));
}
template <> Vec3i value<Vec3i>(uint32_t h) {
    return Vec3i(value<int>(h), value<int>(h * 3), value<int>(h * 7));
}

static math::Transform::Ptr rotated() {
    math::Transform::Ptr t = math::Transform::createLinearTransform(0.25);
    t->preRotate(0.3, math::X_AXIS);
    t->postRotate(-1.1, math::Z_AXIS);
    t->postScale(Vec3d(1, 2, 0.5));
    t->postTranslate(Vec3d(10, -20, 1e5));
    return t;
}

/* A grid by the name of its kind. A constructor called here would have the compiler make all that
 * the library has of each kind already, for a minute. */
template <typename GridT> typename GridT::Ptr created(typename GridT::ValueType background) {
    auto grid = gridPtrCast<GridT>(GridBase::createGrid(GridT::gridType()));
    grid->tree().root().setBackground(background, true);
    return grid;
}

/* Voxels on and off, tiles on and off of two sizes, a background that is not 0. */
template <typename GridT> typename GridT::Ptr scattered(const char *name, uint32_t background) {
    using V = typename GridT::ValueType;
    auto grid = created<GridT>(value<V>(background));
    auto at = grid->getAccessor();
    for (int i = -20; i <= 25; i++)
        for (int j = -9; j <= 30; j++)
            for (int k = -35; k <= 12; k++) {
                const uint32_t h = mixed(i, j, k);
                if (h % 7 == 0)
                    at.setValue(Coord(i, j, k), value<V>(h));
                else if (h % 7 == 1)
                    at.setValueOff(Coord(i, j, k), value<V>(h));
            }
    grid->fill(CoordBBox(Coord(-16, 40, -40), Coord(7, 55, -9)), value<V>(77), true);
    grid->fill(CoordBBox(Coord(8, 40, -40), Coord(15, 55, -9)), value<V>(99), false);
    grid->fill(CoordBBox(Coord(128, 0, 0), Coord(255, 127, 127)), value<V>(1234567), true);
    grid->setName(name);
    grid->setTransform(rotated());
    return grid;
}

static GridPtrVec all_kinds() {
    GridPtrVec grids;
    grids.push_back(scattered<FloatGrid>("float", 5));
    grids.push_back(scattered<DoubleGrid>("double", 5));
    grids.push_back(scattered<Int32Grid>("int32", 1 << 20));
    grids.push_back(scattered<Int64Grid>("int64", 5));
    grids.push_back(scattered<BoolGrid>("bool", 1));
    grids.push_back(scattered<Vec3SGrid>("vec3s", 5));
    grids.push_back(scattered<Vec3DGrid>("vec3d", 5));
    grids.push_back(scattered<Vec3IGrid>("vec3i", 5));
    MaskGrid::Ptr mask = created<MaskGrid>(false);
    mask->tree().topologyUnion(scattered<BoolGrid>("mask", 1)->tree());
    mask->setName("mask");
    mask->setTransform(rotated());
    grids.push_back(mask);
    return grids;
}

static void write(const std::string &path, const GridPtrVec &grids, uint32_t compression) {
    io::File file(path);
    file.setCompression(compression);
    file.write(grids);
}

static GridPtrVec one(const GridBase::Ptr &grid) {
    return GridPtrVec(1, grid);
}

static GridBase::Ptr no_points() {
    GridBase::Ptr grid = GridBase::createGrid("Tree_ptdataidx32_5_4_3");
    grid->setName("points");
    return grid;
}

static GridBase::Ptr huge_number() {
    auto grid = created<Int64Grid>(0);
    grid->setName("huge");
    grid->getAccessor().setValue(Coord(0, 0, 0), int64_t(1) << 60);
    grid->getAccessor().setValue(Coord(3, 3, 3), 1);
    return grid;
}

static GridBase::Ptr in_frustum() {
    GridBase::Ptr grid = scattered<FloatGrid>("view", 5);
    grid->setTransform(math::Transform::createFrustumTransform(
        BBoxd(Vec3d(0, 0, 0), Vec3d(99, 99, 99)), 0.5, 10, 1));
    return grid;
}

/* Two grids of one tree, and two of one name. */
static GridPtrVec shared_tree() {
    GridPtrVec grids = one(scattered<FloatGrid>("first", 5));
    grids.push_back(grids[0]->copyGrid());
    grids[1]->setName("second");
    grids[1]->setTransform(math::Transform::createLinearTransform(3));
    grids.push_back(scattered<FloatGrid>("twin", 6));
    grids.push_back(scattered<FloatGrid>("twin", 7));
    return grids;
}

static int make(const std::string &folder) {
    const uint32_t usual = io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK;
    const GridPtrVec kinds = all_kinds();
    write(folder + "/blosc.vdb", kinds, usual);
    write(folder + "/zip.vdb", kinds, io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
    write(folder + "/none.vdb", kinds, io::COMPRESS_NONE);
    std::ofstream out(folder + "/stream.vdb", std::ios::binary);
    io::Stream(out).write(kinds);
    out.close();
    write(folder + "/points.vdb", one(no_points()), usual);
    write(folder + "/huge.vdb", one(huge_number()), usual);
    write(folder + "/frustum.vdb", one(in_frustum()), usual);
    write(folder + "/shared.vdb", shared_tree(), usual);
    FloatGrid::Ptr empty = created<FloatGrid>(3);
    empty->setName("empty");
    write(folder + "/empty.vdb", one(empty), usual);
    write(folder + "/nothing.vdb", GridPtrVec(), usual);
    FloatGrid::Ptr sphere = tools::createLevelSetSphere<FloatGrid>(3, Vec3f(1, 2, 3), 0.1f);
    sphere->setName("sphere");
    write(folder + "/sphere.vdb", one(sphere), usual);
    for (const GridBase::Ptr &g : kinds)
        g->setSaveFloatAsHalf(true);
    write(folder + "/half.vdb", kinds, usual);
    return 0;
}

/* Balls of radius 20 until enough is active; fog that grows towards their centres. */
static int make_sparse(const char *path, int n, double percent) {
    FloatGrid::Ptr grid = created<FloatGrid>(0);
    auto at = grid->getAccessor();
    const double wanted = percent / 100 * n * n * n;
    const int r = 20;
    uint32_t seed = 1;
    const auto random = [&] {
        return int((seed = seed * 1664525 + 1013904223) >> 8) % (n - 2 * r);
    };
    for (double active = 0; active < wanted; active += 4.19 * r * r * r) {
        const int x = random() + r, y = random() + r, z = random() + r;
        for (int i = -r; i <= r; i++)
            for (int j = -r; j <= r; j++)
                for (int k = -r; k <= r; k++)
                    if (i * i + j * j + k * k <= r * r)
                        at.setValue(Coord(x + i, y + j, z + k),
                                    1 - float(i * i + j * j + k * k) / (r * r));
    }
    at.setValue(Coord(0, 0, 0), 0.01f);
    at.setValue(Coord(n - 1, n - 1, n - 1), 0.01f);
    grid->setName("density");
    grid->setGridClass(GRID_FOG_VOLUME);
    write(path, one(grid), io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK);
    return 0;
}

/* ---- reading back ---- */

template <typename S> void put(S sample) {
    fwrite(&sample, sizeof sample, 1, stdout);
}
template <typename V> void put_value(const V &v, int) {
    put(v);
}
template <> void put_value<bool>(const bool &v, int) {
    put(uint8_t(v));
}
template <> void put_value<int64_t>(const int64_t &v, int) {
    put(double(v));
}
template <typename T> void put_vector(const math::Vec3<T> &v, int component) {
    const double length =
        std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]);
    if (component > 0)
        put(v[component - 1]);
    else if (std::is_same_v<T, float>)
        put(float(length));
    else
        put(length);
}
template <> void put_value<Vec3s>(const Vec3s &v, int component) {
    put_vector(v, component);
}
template <> void put_value<Vec3d>(const Vec3d &v, int component) {
    put_vector(v, component);
}
template <> void put_value<Vec3i>(const Vec3i &v, int component) {
    put_vector(v, component);
}

template <typename GridT> bool dump_as(const GridBase &base, const CoordBBox &box, int component) {
    const auto *grid = dynamic_cast<const GridT *>(&base);
    if (!grid)
        return false;
    auto at = grid->getConstAccessor();
    for (int k = box.min().z(); k <= box.max().z(); k++)
        for (int j = box.min().y(); j <= box.max().y(); j++)
            for (int i = box.min().x(); i <= box.max().x(); i++)
                put_value<typename GridT::ValueType>(at.getValue(Coord(i, j, k)), component);
    return true;
}

static int dump(int count, char **args) {
    io::File file(args[0]);
    file.open(false);
    const GridBase::Ptr grid = file.readGrid(args[1]);
    const int component = atoi(args[2]);
    CoordBBox box = grid->evalActiveVoxelBoundingBox();
    if (count == 9)
        box = CoordBBox(Coord(atoi(args[3]), atoi(args[4]), atoi(args[5])),
                        Coord(atoi(args[6]), atoi(args[7]), atoi(args[8])));
    printf("%d %d %d %d %d %d\n", box.min().x(), box.min().y(), box.min().z(), box.dim().x(),
           box.dim().y(), box.dim().z());
    for (int i = 0; i < 4; i++) {
        const Coord step(i == 1, i == 2, i == 3);
        const Vec3d p = grid->transform().indexToWorld(box.min() + step);
        printf("%.17g %.17g %.17g ", p.x(), p.y(), p.z());
    }
    printf("\n");
    return !(
        dump_as<FloatGrid>(*grid, box, component) || dump_as<DoubleGrid>(*grid, box, component) ||
        dump_as<Int32Grid>(*grid, box, component) || dump_as<Int64Grid>(*grid, box, component) ||
        dump_as<BoolGrid>(*grid, box, component) || dump_as<MaskGrid>(*grid, box, component) ||
        dump_as<Vec3SGrid>(*grid, box, component) || dump_as<Vec3DGrid>(*grid, box, component) ||
        dump_as<Vec3IGrid>(*grid, box, component));
}

int main(int argc, char **argv) {
    initialize();
    if (argc == 3 && strcmp(argv[1], "make") == 0)
        return make(argv[2]);
    if (argc == 5 && strcmp(argv[1], "sparse") == 0)
        return make_sparse(argv[2], atoi(argv[3]), atof(argv[4]));
    if (argc >= 5 && strcmp(argv[1], "dump") == 0)
        return dump(argc - 2, argv + 2);
    fprintf(stderr,
            "usage: tool_vdb make FOLDER | sparse FILE N PERCENT | dump FILE GRID COMPONENT "
            "[BOX]\n");
    return 2;
}
