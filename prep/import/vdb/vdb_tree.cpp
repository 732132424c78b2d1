#include "prep/import/vdb/vdb_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

extern "C" {
#include "formats/grid/slice_tiles.h"
}
#include "prep/import/vdb/vdb_archive.hpp"

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::GridBase;

/* ---- samples of values ---- */

namespace {

/* Metadata in which `leafcast export' notes the original integer type. */
const char *const narrow_key = "leafcast_type";

/* Conversions of a grid's value: unchanged, one of its components, or their length. */
template <typename V> struct as_it_is {
    using sample = V;
    explicit as_it_is(uint32_t) {}
    V operator()(const V &v) const { return v; }
};
template <> struct as_it_is<bool> {
    using sample = uint8_t;
    explicit as_it_is(uint32_t) {}
    uint8_t operator()(bool v) const { return v; }
};
/* NRRD has no stored type for int64_t. A double holds all likely values. */
template <> struct as_it_is<int64_t> {
    using sample = double;
    explicit as_it_is(uint32_t) {}
    double operator()(int64_t v) const {
        const int64_t most = int64_t(1) << 53;
        if (v > most || v < -most)
            vdb_fail(ST_UNSUPPORTED, "a value of %lld: whole numbers beyond 2^53 have no sample",
                     (long long)v);
        return double(v);
    }
};
/* Integers of fewer bits, kept in 32 bits; the grid's metadata give their type. */
template <typename S> struct narrowed {
    using sample = S;
    explicit narrowed(uint32_t) {}
    S operator()(int32_t v) const {
        if (v < std::numeric_limits<S>::min() || v > std::numeric_limits<S>::max())
            vdb_fail(ST_CORRUPT, "a value of %d, where %s says that it is of fewer bits", v,
                     narrow_key);
        return S(v);
    }
};
template <typename V> struct one_of {
    using sample = typename V::value_type;
    int index;
    explicit one_of(uint32_t component) : index(int(component) - 1) {}
    sample operator()(const V &v) const { return v[index]; }
};
template <typename V> struct length_of {
    using part = typename V::value_type;
    using sample = std::conditional_t<std::is_same_v<part, float>, float, double>;
    explicit length_of(uint32_t) {}
    sample operator()(const V &v) const {
        const double x = double(v[0]), y = double(v[1]), z = double(v[2]);
        return sample(std::sqrt(x * x + y * y + z * z));
    }
};

template <typename S> constexpr sample_type type_of();
template <> constexpr sample_type type_of<uint8_t>() {
    return SAMPLE_U8;
}
template <> constexpr sample_type type_of<int8_t>() {
    return SAMPLE_I8;
}
template <> constexpr sample_type type_of<uint16_t>() {
    return SAMPLE_U16;
}
template <> constexpr sample_type type_of<int16_t>() {
    return SAMPLE_I16;
}
template <> constexpr sample_type type_of<int32_t>() {
    return SAMPLE_I32;
}
template <> constexpr sample_type type_of<float>() {
    return SAMPLE_F32;
}
template <> constexpr sample_type type_of<double>() {
    return SAMPLE_F64;
}

} // namespace

/* ---- a tree ---- */

struct vdb_tree {
    std::string path, name;
    GridBase::Ptr grid;
    CoordBBox box; /* of all slices */

    virtual ~vdb_tree() = default;
    virtual sample_type type() const = 0;
    virtual void read(const CoordBBox &slab, void *slices, uint8_t *busy) = 0;
    virtual void background(void *to) const = 0;
};

namespace {

/* The slices of a slab. They start as background. */
template <typename S> struct target {
    CoordBBox slab;
    S *samples;
    S background;
    uint8_t *busy; /* maps of the slices; null: not wanted */

    S *row(int32_t x, int32_t y, int32_t z) const {
        const Coord d = slab.dim(), at = Coord(x, y, z) - slab.min();
        return samples + (std::size_t(at.z()) * d.y() + at.y()) * d.x() + at.x();
    }
    /* Set all to the background; with maps, only the tiles that differ. */
    void clear() const {
        const Coord d = slab.dim();
        const uint32_t dims[3] = {uint32_t(d.x()), uint32_t(d.y()), uint32_t(d.z())};
        if (!busy)
            std::fill_n(samples, slab.volume(), background);
        for (std::size_t z = 0, tiles = slice_tiles_count(dims); busy && z < dims[2]; z++)
            for (std::size_t i = 0; i < tiles; i++) {
                if (!busy[z * tiles + i])
                    continue;
                const slice_tile t = slice_tiles_at(dims, i);
                slice_tiles_fill(dims, &t, sizeof(S), &background, samples + z * dims[0] * dims[1]);
                busy[z * tiles + i] = 0;
            }
    }
    /* Mark a part of the slab as busy. */
    void touch(const CoordBBox &part) const {
        if (!busy || part.empty())
            return;
        const Coord d = slab.dim(), low = part.min() - slab.min(), high = part.max() - slab.min();
        const std::size_t across = slice_tiles_along(uint32_t(d.x())),
                          tiles = across * slice_tiles_along(uint32_t(d.y()));
        for (int32_t z = low.z(); z <= high.z(); z++)
            for (int32_t y = low.y() / SLICE_TILE; y <= high.y() / SLICE_TILE; y++)
                std::fill_n(busy + z * tiles + y * across + low.x() / SLICE_TILE,
                            high.x() / SLICE_TILE - low.x() / SLICE_TILE + 1, uint8_t(1));
    }
    void fill(CoordBBox part, S value) const {
        if (memcmp(&value, &background, sizeof value) == 0)
            return;
        part.intersect(slab);
        touch(part);
        for (int32_t z = part.min().z(); z <= part.max().z(); z++)
            for (int32_t y = part.min().y(); y <= part.max().y(); y++)
                std::fill_n(row(part.min().x(), y, z), part.dim().x(), value);
    }
};

template <typename GridT, typename Take> struct tree_of final : vdb_tree {
    using sample = typename Take::sample;
    using tree = typename GridT::TreeType;
    using leaf = typename tree::LeafNodeType;
    Take take;

    explicit tree_of(uint32_t component) : take(component) {}
    sample_type type() const override { return type_of<sample>(); }

    void fill(leaf &node, const target<sample> &to) {
        CoordBBox part = node.getNodeBoundingBox();
        const Coord origin = part.min();
        const openvdb::Index stride = leaf::DIM * leaf::DIM;
        part.intersect(to.slab);
        to.touch(part);
        for (int32_t z = part.min().z(); z <= part.max().z(); z++)
            for (int32_t y = part.min().y(); y <= part.max().y(); y++) {
                sample *row = to.row(part.min().x(), y, z);
                openvdb::Index n = leaf::coordToOffset(Coord(part.min().x(), y, z) - origin);
                for (int32_t x = part.min().x(); x <= part.max().x(); x++, n += stride)
                    *row++ = take(node.getValue(n));
            }
    }

    /* Fill the slots of a node that meet the slab. Free what ends in the slab: it is not needed
     * again. */
    template <typename Node> void fill(Node &node, const target<sample> &to) {
        using Child = typename Node::ChildNodeType;
        const int32_t size = Child::DIM;
        const Coord origin = node.origin();
        CoordBBox part = node.getNodeBoundingBox();
        part.intersect(to.slab);
        if (part.empty())
            return;
        const Coord low = part.min() - origin, high = part.max() - origin;
        for (int32_t x = low.x() / size; x <= high.x() / size; x++)
            for (int32_t y = low.y() / size; y <= high.y() / size; y++)
                for (int32_t z = low.z() / size; z <= high.z() / size; z++)
                    fill_slot(node, Node::coordToOffset(Coord(x * size, y * size, z * size)), to);
    }

    template <typename Node>
    void fill_slot(Node &node, openvdb::Index n, const target<sample> &to) {
        using Child = typename Node::ChildNodeType;
        const CoordBBox part = CoordBBox::createCube(node.offsetToGlobalCoord(n), Child::DIM);
        if (!node.isChildMaskOn(n)) {
            to.fill(part, take(node.getTable()[n].getValue()));
            return;
        }
        fill(*const_cast<Child *>(node.getTable()[n].getChild()), to);
        if (part.max().z() <= to.slab.max().z())
            node.addTile(n, openvdb::zeroVal<typename Node::ValueType>(), false);
    }

    void background(void *to) const override {
        const sample s = take(static_cast<const GridT &>(*grid).tree().root().background());
        memcpy(to, &s, sizeof s);
    }

    void read(const CoordBBox &slab, void *slices, uint8_t *busy) override {
        auto &root = static_cast<GridT &>(*grid).tree().root();
        const target<sample> to{slab, static_cast<sample *>(slices), take(root.background()), busy};
        to.clear();
        for (auto tile = root.cbeginValueAll(); tile; ++tile)
            to.fill(CoordBBox::createCube(tile.getCoord(), tree::RootNodeType::ChildNodeType::DIM),
                    take(*tile));
        for (auto child = root.beginChildOn(); child; ++child)
            fill(*child, to);
    }
};

template <typename S> using narrow_tree = tree_of<openvdb::Int32Grid, narrowed<S>>;

/* Make a tree for integers whose metadata give the original type; null for others. */
std::unique_ptr<vdb_tree> make_narrow(const GridBase &grid) {
    const auto said = grid.getMetadata<openvdb::StringMetadata>(narrow_key);
    if (!said || grid.type() != openvdb::Int32Grid::gridType())
        return nullptr;
    const std::string &type = said->value();
    if (type == "u8")
        return std::make_unique<narrow_tree<uint8_t>>(0);
    if (type == "i8")
        return std::make_unique<narrow_tree<int8_t>>(0);
    if (type == "u16")
        return std::make_unique<narrow_tree<uint16_t>>(0);
    if (type == "i16")
        return std::make_unique<narrow_tree<int16_t>>(0);
    return nullptr;
}

/* ---- kinds of grids ---- */

template <typename GridT, template <typename> class Take>
std::unique_ptr<vdb_tree> make(uint32_t component) {
    return std::make_unique<tree_of<GridT, Take<typename GridT::ValueType>>>(component);
}

/* components 0: a scalar. */
struct kind {
    openvdb::Name type;
    uint32_t components;
    std::unique_ptr<vdb_tree> (*whole)(uint32_t component);
    std::unique_ptr<vdb_tree> (*part)(uint32_t component);
};

template <typename GridT> kind scalar() {
    return {GridT::gridType(), 0, make<GridT, as_it_is>, make<GridT, as_it_is>};
}
template <typename GridT> kind vector() {
    return {GridT::gridType(), 3, make<GridT, length_of>, make<GridT, one_of>};
}

const kind *find_kind(const openvdb::Name &type) {
    static const kind kinds[] = {
        scalar<openvdb::FloatGrid>(), scalar<openvdb::DoubleGrid>(), scalar<openvdb::Int32Grid>(),
        scalar<openvdb::Int64Grid>(), scalar<openvdb::BoolGrid>(),   scalar<openvdb::MaskGrid>(),
        vector<openvdb::Vec3SGrid>(), vector<openvdb::Vec3DGrid>(),  vector<openvdb::Vec3IGrid>()};
    for (const kind &k : kinds)
        if (k.type == type)
            return &k;
    return nullptr;
}

const char *why_not(const vdb_grid &g) {
    if (find_kind(g.entry.gridType()))
        return nullptr;
    return g.entry.gridType().find("ptdataidx") != std::string::npos
               ? "points, which are no samples: make a volume of them first (vdb_tool -points2ls)"
               : "of this type there are no samples";
}

/* ---- choosing ---- */

const vdb_grid &choose(const vdb_archive &archive, const vdb_request &q) {
    const vdb_grid *refused = nullptr;
    for (const vdb_grid &g : archive.grids()) {
        if (q.field ? g.name != q.field : why_not(g) != nullptr) {
            refused = refused ? refused : &g;
            continue;
        }
        if (const char *why = why_not(g))
            vdb_fail(ST_UNSUPPORTED, "%s: grid \"%s\" is of type %s: %s", q.path, g.name.c_str(),
                     g.entry.gridType().c_str(), why);
        return g;
    }
    if (q.field)
        vdb_fail(ST_UNSUPPORTED, "%s: no grid \"%s\"; `%s' tells what there is", q.path, q.field,
                 q.list);
    if (refused)
        vdb_fail(ST_UNSUPPORTED, "%s: no grid of samples: \"%s\" is of type %s: %s", q.path,
                 refused->name.c_str(), refused->entry.gridType().c_str(), why_not(*refused));
    vdb_fail(ST_UNSUPPORTED, "%s: there is no grid in it", q.path);
}

std::unique_ptr<vdb_tree> make_tree(const vdb_grid &g, const vdb_request &q) {
    const kind *k = find_kind(g.entry.gridType());
    const uint32_t most = k->components ? k->components : 1;
    if (q.component > most)
        vdb_fail(ST_USAGE, "--component %u: grid \"%s\" of %s has %u", q.component, g.name.c_str(),
                 q.path, most);
    return q.component ? k->part(q.component) : k->whole(0);
}

/* ---- where it lies ---- */

CoordBBox padded(const CoordBBox &box, const vdb_request &q) {
    int64_t corner[2][3];
    for (int a = 0; a < 3; a++) {
        corner[0][a] = int64_t(box.min()[a]) - q.pad;
        corner[1][a] = int64_t(box.max()[a]) + q.pad;
        if (corner[0][a] < std::numeric_limits<int32_t>::min() ||
            corner[1][a] >= std::numeric_limits<int32_t>::max())
            vdb_fail(ST_UNSUPPORTED, "%s: a box that reaches beyond the coordinates that there are",
                     q.path);
    }
    return CoordBBox(int32_t(corner[0][0]), int32_t(corner[0][1]), int32_t(corner[0][2]),
                     int32_t(corner[1][0]), int32_t(corner[1][1]), int32_t(corner[1][2]));
}

CoordBBox box_of(const vdb_tree &t, const vdb_request &q) {
    CoordBBox box(Coord(q.box[0]), Coord(q.box[1]));
    if (!q.boxed)
        box = t.grid->evalActiveVoxelBoundingBox();
    if (box.empty())
        vdb_fail(ST_UNSUPPORTED, "%s: grid \"%s\" has no active voxel: --box says what to take",
                 q.path, t.name.c_str());
    return padded(box, q);
}

/* OpenVDB multiplies row vectors by its maps: the axes are the matrix's first rows. */
void place(const vdb_tree &t, double to_world[3][4]) {
    if (!t.grid->transform().isLinear())
        vdb_fail(ST_UNSUPPORTED,
                 "%s: grid \"%s\" lies in a frustum; only affine maps can be taken: resample it "
                 "first",
                 t.path.c_str(), t.name.c_str());
    const openvdb::math::Mat4d m = t.grid->transform().baseMap()->getAffineMap()->getMat4();
    const Coord low = t.box.min();
    for (int row = 0; row < 3; row++) {
        for (int a = 0; a < 3; a++)
            to_world[row][a] = m(a, row);
        to_world[row][3] =
            m(3, row) + low.x() * m(0, row) + low.y() * m(1, row) + low.z() * m(2, row);
    }
}

void open_tree(const vdb_request &q, vdb_facts &facts, std::unique_ptr<vdb_tree> &t) {
    vdb_archive archive(q.path);
    const vdb_grid &g = choose(archive, q);
    t = make_tree(g, q);
    const GridBase::Ptr grid = archive.load(g);
    if (auto narrow = make_narrow(*grid))
        t = std::move(narrow);
    t->path = q.path;
    t->name = g.name;
    t->grid = grid;
    t->box = box_of(*t, q);
    facts.name = t->name.c_str();
    facts.type = t->type();
    for (int a = 0; a < 3; a++)
        facts.dims[a] = uint64_t(int64_t(t->box.max()[a]) - t->box.min()[a] + 1);
    place(*t, facts.to_world);
}

/* ---- listing ---- */

std::string describe(const vdb_grid &g, const GridBase &grid) {
    std::string text = grid.valueType();
    if (g.entry.saveFloatAsHalf())
        text += ", half";
    if (grid.getGridClass() != openvdb::GRID_UNKNOWN)
        text += ", " + GridBase::gridClassToMenuName(grid.getGridClass());
    return text;
}

status list_grid(vdb_archive &archive, const vdb_grid &g,
                 status (*take)(void *ctx, const vdb_entry *e), void *ctx) {
    const char *refuse = why_not(g);
    const GridBase::Ptr grid = refuse ? g.empty : archive.load(g);
    const std::string type = describe(g, *grid);
    const kind *k = find_kind(g.entry.gridType());
    vdb_entry e = {g.name.c_str(), type.c_str(), {0, 0, 0}, refuse, k ? k->components : 0};
    const CoordBBox box = refuse ? CoordBBox() : grid->evalActiveVoxelBoundingBox();
    for (int a = 0; a < 3 && !box.empty(); a++)
        e.dims[a] = uint64_t(int64_t(box.max()[a]) - box.min()[a] + 1);
    if (!refuse && !grid->transform().isLinear())
        e.refuse = "it lies in a frustum";
    return take(ctx, &e);
}

} // namespace

/* ---- what C calls ---- */

status vdb_tree_open(const vdb_request *q, vdb_facts *facts, vdb_tree **out) {
    try {
        std::unique_ptr<vdb_tree> t;
        vdb_begin();
        open_tree(*q, *facts, t);
        *out = t.release();
        return ST_OK;
    } catch (...) {
        return vdb_told(q->path);
    }
}

status vdb_tree_read(vdb_tree *t, uint32_t first, uint32_t count, void *slices, uint8_t *busy) {
    try {
        CoordBBox slab = t->box;
        slab.min().z() = t->box.min().z() + int32_t(first);
        slab.max().z() = slab.min().z() + int32_t(count) - 1;
        t->read(slab, slices, busy);
        return ST_OK;
    } catch (...) {
        return vdb_told(t->path);
    }
}

void vdb_tree_background(const vdb_tree *t, void *sample) {
    t->background(sample);
}

void vdb_tree_close(vdb_tree *t) {
    delete t;
}

status vdb_tree_list(const char *path, status (*take)(void *ctx, const vdb_entry *e), void *ctx) {
    try {
        vdb_begin();
        vdb_archive archive(path);
        for (const vdb_grid &g : archive.grids()) {
            const status st = list_grid(archive, g, take, ctx);
            if (st != ST_OK)
                return st;
        }
        return ST_OK;
    } catch (...) {
        return vdb_told(path);
    }
}
