/// Fabrics: the topology of a triangle mesh, cooked once into the order in which constraints are projected. Immutable,
/// shared by instances, independent of any world.
///
///     wisp_fabric_def def = wisp_default_fabric_def();
///     def.points = points, def.vertex_count = vertex_count;
///     def.triangles = triangles, def.triangle_count = triangle_count;
///     def.attachments = corners, def.attachment_count = 2, def.tethers = true;
///     wisp_fabric* fabric;
///     wisp_error error = { 0 };
///     wisp_status status = wisp_fabric_cook( &def, NULL, &fabric, &error );   // error.message names a wrong element
///     ...                                                                     // add any number of surfaces of it
///     wisp_fabric_release( fabric );
///
/// A vertex has two numbers: the user's, and its *slot*, its place in the order of the fabric (Cuthill-McKee from the
/// attachments, so that neighbours in the mesh are neighbours in memory). Tiles are ranges of slots. Every tile has
/// one *dummy* slot after the vertices; padding of constraint lists refers to it, and it never moves. Arrays whose name
/// ends in _x4 hold slots times 4, ready to index columns of four floats.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Constraints of a group, which share no vertex.
#define WISP_FABRIC_LANES 8
#define WISP_FABRIC_MAX_LEVELS 12
/// Most tethers of a vertex, and most parents of a vertex in a coarse level.
#define WISP_FABRIC_MAX_TETHERS 4
#define WISP_FABRIC_PARENTS 3

/// In which order constraints of a tile are projected.
typedef enum wisp_solve_order
{
    WISP_SOLVE_ORDER_COLOUR = 0, ///< colour by colour: stable at any stiffness
    WISP_SOLVE_ORDER_LIST =
        1, ///< along the mesh from the attachments: carries error further a pass, can pump energy when
           ///< constraints are stiff (see the stability table)
    WISP_SOLVE_ORDER_COUNT = 2,
} wisp_solve_order;

/// Arrays that a lean fabric has only where something asked for them with wisp_fabric_need(). Spans and strips are so in any fabric.
typedef enum wisp_fabric_arrays
{
    WISP_FABRIC_EDGES = 1,   ///< `edges`
    WISP_FABRIC_RINGS = 2,   ///< `ring_begin` and `ring_x4`
    WISP_FABRIC_SPANS = 4,   ///< `hinge_span2`
    WISP_FABRIC_STRIPS = 8,  ///< `strips`
    WISP_FABRIC_HINGES = 16, ///< `hinges` and `link_order.constraint`
} wisp_fabric_arrays;

/// What to cook. Fill from wisp_default_fabric_def(). Need not outlive the call.
typedef struct wisp_fabric_def
{
    uint32_t size;            ///< bytes; set by wisp_default_fabric_def()
    const wisp_vec3* points;  ///< [vertex_count] m, the rest shape; finite, within 1e6 m of the origin
    const int32_t* triangles; ///< [triangle_count][3] counter-clockwise seen from outside
    int vertex_count, triangle_count;
    const int32_t*
        attachments; ///< [attachment_count] vertices that hold the fabric: the order begins there, tethers reach to
                     ///< them, and coarse sheets have them where they are not close together; may be empty
    int attachment_count;
    bool
        bend_links; ///< default true: a link between the opposite vertices of every interior edge, listed after the edges
    bool hinges;  ///< default false: the four vertices of every interior edge, for bending by angle
    bool tethers; ///< default false: distances along the mesh to the nearest attachments
    bool
        coarse_sheets; ///< default false: coarse sheets, each with about a quarter of the vertices of the next finer one, down to
                       ///< about 17 x 17. A small mesh has none
    bool
        lean; ///< default false: all arrays are kept. true: those of wisp_fabric_arrays are null until something needs them, which
    ///< saves about 130 bytes per vertex where nothing does. Effects and requests of a world ask for what they need
    wisp_solve_order solve_order; ///< default WISP_SOLVE_ORDER_COLOUR
    int tile_size; ///< vertices, a multiple of 8 in 64 .. 65536; default 0: 1024, 512 or 256, so that there are at least 4
    int workers; ///< 1 .. WISP_MAX_WORKERS that cook coarse sheets of 4096 vertices and more; default 1: the calling thread alone
} wisp_fabric_def;

WISP_DEFINITION( fabric_def );

/// Constraints in the order of projection. Tiles of one colour share no vertex, so they run in parallel; within a tile
/// each group of eight slots shares no vertex, so it runs in lanes.
typedef struct wisp_schedule
{
    int slot_count;             ///< padding included, a multiple of 8
    int tile_count;             ///< that have constraints
    int colour_count;           ///< of tiles
    const int32_t* colour_tile; ///< [colour_count + 1] first tile of a colour
    const int32_t* tile_begin;  ///< [tile_count + 1] first slot, multiples of 8
    const int32_t* constraint;  ///< [slot_count] number of the constraint, -1 pads
} wisp_schedule;

/// Triangles as strips, eight side by side: in each step a lane takes the next vertex, which is a triangle with the two that it has,
/// and one of these two leaves, so it reads one vertex a triangle. Lanes begin and end with dummies. A row of sums may be written by two
/// lanes of a step, in the order of lanes.
typedef struct wisp_strips
{
    wisp_schedule order;              ///< of tiles; slots are steps, and constraint is null
    const int32_t ( *next_x4 )[8];    ///< [step] slots times 4
    const int32_t ( *leaving_x4 )[8]; ///< [step]
    const uint16_t* flags; ///< [step] bit l: lane l has a triangle; bit 8 + l: the older of its two vertices stays
} wisp_strips;

/// A coarse sheet: a subset of the vertices of the next finer sheet, linked like a mesh. It has rows of its own, in the order of
/// the slots; tiles are ranges of rows, and every tile has one dummy row after the vertices, as slots have.
typedef struct wisp_fabric_level
{
    int vertex_count;
    int tile_size;
    int row_count;             ///< vertices and dummies, padded to a multiple of 8
    int first_row, first_link; ///< of this level in tables that hold all levels, from fine to coarse
    int unlinked_count;        ///< vertices of the mesh that no coarse vertex is near: they move on their own
    const int32_t* slot_x4;    ///< [row_count] slots times 4; the first dummy pads

    /// Links between neighbours: the edges of a Delaunay triangulation. Where four vertices lie on one circle, or nearly so, there
    /// are both diagonals, and each is a fraction of a link.
    int link_count;
    wisp_schedule schedule;     ///< a level of few links is one tile
    const int32_t *a_x4, *b_x4; ///< [schedule.slot_count] rows times 4
    const float* rest;          ///< [schedule.slot_count] m, distance along the rest mesh; 0 pads
    float mean_rest;            ///< m, of the links
    const float* fraction;      ///< [schedule.slot_count] of a link's stiffness, in (0, 1]; 0 pads

    /// Chains of mesh edges from one end of a link to the other, in groups of eight links: entry e of group g is at
    /// chain_x4[chain_begin[g] + e]. The last vertex of a chain pads.
    int chain_group_count;          ///< schedule.slot_count / 8
    const int32_t* chain_begin;     ///< [chain_group_count + 1]
    const int32_t ( *chain_x4 )[8]; ///< [entry] slots times 4
    const float* chain_rest;        ///< [schedule.slot_count] m, 0 pads

    /// Which vertices of this level a row of the next finer one (or a slot, for the first level) follows, in slices of eight.
    int finer_row_count;
    const int32_t* parent_x4; ///< [slice][WISP_FABRIC_PARENTS][8] rows times 4
    const float* weight; ///< [slice][WISP_FABRIC_PARENTS][8] they sum to 1, or are all 0 where nothing is followed
} wisp_fabric_level;

typedef struct wisp_fabric
{
    int vertex_count, triangle_count;
    int tile_size, tile_count; ///< tile of a slot is slot / tile_size; dummies are slots vertex_count + tile
    int slot_count;            ///< vertices and dummies, padded to a multiple of 8

    const int32_t* vertex_slot; ///< [vertex_count] slot of the user's vertex
    const int32_t* slot_vertex; ///< [slot_count] the user's vertex, -1 for a dummy
    const wisp_vec3* rest;      ///< [slot_count] m, rest shape; dummies at the first vertex
    const float* area;          ///< [slot_count] m^2, a third of the areas of the triangles at the vertex
    const int32_t* triangles;   ///< [triangle_count][3] slots, triangles in the user's order

    int edge_count;        ///< structural edges, each once
    const int32_t* edges;  ///< [edge_count][2] slots, a < b
    int hinge_count;       ///< interior edges with two triangles
    const int32_t* hinges; ///< [hinge_count][4] slots: the edge's ends i, j, and the opposite vertices k, l of the
                           ///< triangle (i, j, k) and of the triangle (j, i, l); k is l when they lie back to back
    int open_edge_count;   ///< edges of one triangle; 0 for a closed mesh
    int nonmanifold_edge_count; ///< edges of more than two triangles, or used twice in one direction; they have no hinge

    int link_count;            ///< edges, then bend links (k, l) of the hinges if bend_links is set
    wisp_schedule link_order;  ///< constraint numbers below edge_count are edges
    const uint8_t* link_bends; ///< [link_order.slot_count / 8] bit l: lane l has a bend link; three more may be read
    const int32_t *link_a_x4, *link_b_x4; ///< [link_order.slot_count]
    const float* link_rest;               ///< [link_order.slot_count] m, 0 pads

    wisp_schedule hinge_order;    ///< empty unless hinges is set
    const int32_t* hinge_slot_x4; ///< [hinge_order.slot_count / 8][4][8] i, j, k, l
    const float* hinge_span2;     ///< [hinge_order.slot_count] m^2, squared distance of k and l at rest; 0 pads

    /// Triangles around each vertex as fans, in slices of eight slots: entry e of slice s is at ring4[ring_begin[s] + e].
    /// A lane lists neighbours of its vertex v; two entries a, b in a row are the triangle (v, a, b), unless one of them
    /// is v itself. The own slot stands between two fans and pads, for its difference to v is 0 and adds nothing to a
    /// sum. A closed fan ends with the neighbour it begins with, so a vertex inside a surface has one entry more than
    /// triangles. Order: open fans, then closed ones, each kind in the user's order of the triangles they begin with; an
    /// open fan begins at an open edge, a closed one with the user's first triangle that is in no fan yet. Where several
    /// triangles continue from a neighbour, the user's first one does.
    int ring_slice_count;          ///< slot_count / 8
    const int32_t* ring_begin;     ///< [ring_slice_count + 1]
    const int32_t ( *ring_x4 )[8]; ///< [entry]

    wisp_strips strips;

    int tether_count;         ///< tethers a vertex, 0 .. WISP_FABRIC_MAX_TETHERS
    const int32_t* tether_x4; ///< [tether_count][slot_count] the attachment's slot times 4; the own slot pads
    const float* tether_rest; ///< [tether_count][slot_count] m along the rest mesh, never below the straight distance

    int attachment_count;
    const int32_t* attachments; ///< [attachment_count] slots, each once, in the user's order

    int level_count;
    const wisp_fabric_level* levels; ///< [level_count] from fine to coarse
    wisp_solve_order solve_order;
    uint64_t
        hash; ///< of everything above but spans, strips and bits of bend links: the same fabric has the same hash on every machine
} wisp_fabric;

/// Cook a mesh. Takes unreferenced vertices and nonmanifold edges as they are; triangles without area keep their edges and add no
/// area.
/// @param allocator null: the C library; it must outlive the fabric
/// @param out receives the fabric with one reference, null on failure
/// @return WISP_BAD_INPUT an index is out of range, a triangle names a vertex twice, a point is not finite (the message
///         names triangle or vertex), more than 2^26 vertices or 2^25 triangles; WISP_NO_MEMORY
WISP_API wisp_status wisp_fabric_cook( const wisp_fabric_def* def, const wisp_allocator* allocator, wisp_fabric** out,
                                       wisp_error* error );

/// Add a reference. Thread-safe, as is the release.
WISP_API void wisp_fabric_retain( wisp_fabric* fabric );
/// Drop a reference; the last one frees the fabric. Null is allowed.
WISP_API void wisp_fabric_release( wisp_fabric* fabric );

/// Make arrays that a lean fabric does not have yet. Thread-safe; they stay as long as the fabric.
/// @param arrays wisp_fabric_arrays or-ed
/// @return WISP_NO_MEMORY; WISP_BAD_INPUT the fabric is null
WISP_API wisp_status wisp_fabric_need( const wisp_fabric* fabric, unsigned arrays );

/// Find the edge between two neighbouring slots. The fabric has its edges: wisp_fabric_need() makes those of a lean one.
/// @return its number; that of another edge if the two are no neighbours
WISP_API int wisp_fabric_find_edge( const wisp_fabric* fabric, int32_t a, int32_t b );

/// @return bytes in memory
WISP_API size_t wisp_fabric_bytes( const wisp_fabric* fabric );

WISP_END_C
