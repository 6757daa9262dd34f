/// Meshes to cook, and properties of every fabric, checked by brute force on the user's triangles.
#pragma once

#include "support.h"

#include "fabric.h"
#include "test_mesh.h"
#include "wisp/module/surface_kernels.h"

/// For locals that point to a fabric.
static inline void fabric_local( wisp_fabric** local )
{
    wisp_fabric_release( *local );
}

// ---- meshes ----

static inline void test_mesh_triangle( test_mesh* mesh, int* next, int32_t a, int32_t b, int32_t c )
{
    int32_t* t = mesh->triangles + 3 * (size_t)( *next )++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static inline void test_mesh_cell( test_mesh* mesh, int* next, int32_t a, int32_t b, int32_t c, int32_t d,
                                   bool turned )
{
    test_mesh_triangle( mesh, next, a, b, turned ? c : d );
    test_mesh_triangle( mesh, next, turned ? a : b, c, d );
}

/// width x height vertices, a metre apart, diagonals alternating.
static inline test_mesh test_mesh_plane( int width, int height )
{
    test_mesh mesh = test_mesh_make( width * height, 2 * ( width - 1 ) * ( height - 1 ) );
    int next = 0;
    for ( int y = 0; y < height; ++y )
    {
        for ( int x = 0; x < width; ++x )
        {
            int v = y * width + x;
            mesh.points[v] = ( wisp_vec3 ){ (float)x, 0.0f, (float)y };
            if ( x + 1 < width && y + 1 < height )
            {
                test_mesh_cell( &mesh, &next, v, v + 1, v + width + 1, v + width, ( ( x + y ) & 1 ) != 0 );
            }
        }
    }
    return mesh;
}

/// A closed sphere of rings and slices; its two poles have as many neighbours as there are slices.
static inline test_mesh test_mesh_sphere( int rings, int slices )
{
    test_mesh mesh = test_mesh_make( rings * slices + 2, 2 * rings * slices );
    int north = rings * slices, south = north + 1, next = 0;
    mesh.points[north] = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    mesh.points[south] = ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f };
    for ( int r = 0; r < rings; ++r )
    {
        double polar = 3.14159265358979 * ( r + 1 ) / ( rings + 1 );
        for ( int s = 0; s < slices; ++s )
        {
            double turn = 6.28318530717959 * s / slices;
            int right = ( s + 1 ) % slices;
            mesh.points[r * slices + s] = ( wisp_vec3 ){ (float)( sin( polar ) * cos( turn ) ), (float)cos( polar ),
                                                         (float)( sin( polar ) * sin( turn ) ) };
            if ( r == 0 )
            {
                test_mesh_triangle( &mesh, &next, north, right, s );
            }
            if ( r + 1 < rings )
            {
                int v = r * slices, below = v + slices;
                test_mesh_cell( &mesh, &next, v + s, v + right, below + right, below + s, ( s & 1 ) != 0 );
            }
            else
            {
                test_mesh_triangle( &mesh, &next, south, r * slices + s, r * slices + right );
            }
        }
    }
    return mesh;
}

/// A band of `length` cells, `height` vertices across, whose end is twisted and joined to its beginning.
static inline test_mesh test_mesh_moebius( int length, int height )
{
    test_mesh mesh = test_mesh_make( length * height, 2 * length * ( height - 1 ) );
    int next = 0;
    for ( int x = 0; x < length; ++x )
    {
        for ( int y = 0; y < height; ++y )
        {
            double turn = 6.28318530717959 * x / length, foreign = y - ( height - 1 ) * 0.5, radius = length;
            double reach = radius + foreign * cos( turn / 2 );
            mesh.points[x * height + y] =
                ( wisp_vec3 ){ (float)( reach * cos( turn ) ), (float)( reach * sin( turn ) ),
                               (float)( foreign * sin( turn / 2 ) ) };
            if ( y + 1 < height )
            {
                bool seam = x + 1 == length;
                int a = x * height + y;
                int b = seam ? height - 1 - y : a + height, c = seam ? height - 2 - y : a + height + 1;
                test_mesh_cell( &mesh, &next, a, b, c, a + 1, false );
            }
        }
    }
    return mesh;
}

/// `pages` triangles at one edge.
static inline test_mesh test_mesh_book( int pages )
{
    test_mesh mesh = test_mesh_make( pages + 2, pages );
    int next = 0;
    mesh.points[1].z = 1.0f;
    for ( int p = 0; p < pages; ++p )
    {
        mesh.points[p + 2] = ( wisp_vec3 ){ cosf( (float)p ), sinf( (float)p ), 0.5f };
        test_mesh_triangle( &mesh, &next, p % 2, 1 - p % 2, p + 2 );
    }
    return mesh;
}

/// Vertex 0 in the middle of a fan.
static inline test_mesh test_mesh_fan( int spokes )
{
    test_mesh mesh = test_mesh_make( spokes + 1, spokes );
    int next = 0;
    for ( int s = 0; s < spokes; ++s )
    {
        double turn = 6.28318530717959 * s / spokes;
        mesh.points[s + 1] = ( wisp_vec3 ){ (float)cos( turn ), (float)sin( turn ), 0.0f };
        test_mesh_triangle( &mesh, &next, 0, s + 1, ( s + 1 ) % spokes + 1 );
    }
    return mesh;
}

/// The same mesh, its vertices and triangles in another order.
static inline void test_mesh_shuffle( test_mesh* mesh )
{
    for ( int i = mesh->vertex_count - 1; i > 0; --i )
    {
        int j = test_random( i, 1, i + 1 );
        wisp_vec3 p = mesh->points[i];
        mesh->points[i] = mesh->points[j];
        mesh->points[j] = p;
        for ( int k = 0; k < 3 * mesh->triangle_count; ++k )
        {
            int32_t v = mesh->triangles[k];
            mesh->triangles[k] = v == i ? j : v == j ? i : v;
        }
    }
    for ( int i = mesh->triangle_count - 1; i > 0; --i )
    {
        int32_t kept[3];
        int32_t *a = mesh->triangles + 3 * (size_t)i, *b = mesh->triangles + 3 * (size_t)test_random( i, 2, i + 1 );
        memcpy( kept, a, sizeof( kept ) );
        memmove( a, b, sizeof( kept ) );
        memcpy( b, kept, sizeof( kept ) );
    }
}

static inline wisp_fabric* test_fabric_cook( const wisp_fabric_def* def )
{
    wisp_fabric* fabric = NULL;
    wisp_error error = { 0 };
    assert_int_equal( wisp_fabric_cook( def, NULL, &fabric, &error ), WISP_OK );
    assert_non_null( fabric );
    return fabric;
}

// ---- properties of fabrics ----

/// No lane or tile writes a slot that another lane of the group or another tile of the colour uses. `slot4` gives the
/// slots of a lane.
typedef int32_t test_slot4_fn( const wisp_fabric* f, int32_t at, int k );

static inline int32_t test_link_slot_x4( const wisp_fabric* f, int32_t at, int k )
{
    return k == 0 ? f->link_a_x4[at] : f->link_b_x4[at];
}

static inline int32_t test_hinge_slot_x4( const wisp_fabric* f, int32_t at, int k )
{
    return f->hinge_slot_x4[( (size_t)( at / 8 ) * 4 + (size_t)k ) * 8 + (size_t)( at % 8 )];
}

static inline void assert_tile_is_safe( const wisp_fabric* f, const wisp_schedule* s, int arity,
                                        test_slot4_fn* slot_x4, int tile, int32_t* tile_of_slot,
                                        int32_t* lane_of_slot )
{
    assert_true( s->tile_begin[tile] % 8 == 0 && s->tile_begin[tile] < s->tile_begin[tile + 1] );
    assert_true( s->constraint[s->tile_begin[tile]] >= 0 );
    for ( int32_t i = s->tile_begin[tile]; i < s->tile_begin[tile + 1]; ++i )
    {
        for ( int k = 0; k < arity; ++k )
        {
            int32_t slot = slot_x4( f, i, k ) / 4;
            assert_true( slot_x4( f, i, k ) % 4 == 0 && slot >= 0 && slot < f->vertex_count + f->tile_count );
            assert_int_equal( slot >= f->vertex_count, s->constraint[i] < 0 );

            // other tiles of the colour, dummies included
            assert_true( tile_of_slot[slot] == -1 || tile_of_slot[slot] == tile );
            tile_of_slot[slot] = tile;

            // other lanes of the group
            bool shared = lane_of_slot[slot] / 8 == i / 8 && lane_of_slot[slot] != i && slot < f->vertex_count;
            assert_false( shared );
            lane_of_slot[slot] = i;
        }
    }
}

static inline void assert_schedule_is_safe( const wisp_fabric* f, const wisp_schedule* s, int arity, int count,
                                            test_slot4_fn* slot_x4 )
{
    size_t bytes = (size_t)f->slot_count * sizeof( int32_t );
    SCOPED( free_local ) int32_t* tile_of_slot = malloc( bytes + 1 );
    SCOPED( free_local ) int32_t* lane_of_slot = malloc( bytes + 1 );
    SCOPED( free_local ) bool* seen = calloc( (size_t)count + 1, sizeof( bool ) );
    int found = 0;
    for ( int i = 0; i < f->slot_count; ++i )
    {
        lane_of_slot[i] = -8;
    }
    assert_int_equal( s->colour_tile[0], 0 );
    assert_int_equal( s->tile_begin[0], 0 );
    assert_int_equal( s->colour_tile[s->colour_count], s->tile_count );
    assert_int_equal( s->tile_begin[s->tile_count], s->slot_count );
    for ( int colour = 0; colour < s->colour_count; ++colour )
    {
        assert_true( s->colour_tile[colour] < s->colour_tile[colour + 1] );
        memset( tile_of_slot, 0xff, bytes );
        for ( int tile = s->colour_tile[colour]; tile < s->colour_tile[colour + 1]; ++tile )
        {
            assert_tile_is_safe( f, s, arity, slot_x4, tile, tile_of_slot, lane_of_slot );
        }
    }
    for ( int32_t i = 0; i < s->slot_count; ++i )
    {
        if ( s->constraint[i] >= 0 )
        {
            assert_true( s->constraint[i] < count );
            assert_false( seen[s->constraint[i]] );
            seen[s->constraint[i]] = true;
            found += 1;
        }
    }
    assert_int_equal( found, count );
}

/// No two links of a level that run in parallel share a row; parents and chains stay within their arrays.
static inline void assert_level_is_safe( const wisp_fabric* f, const wisp_fabric_level* level )
{
    wisp_fabric of_level = *f;
    of_level.link_a_x4 = level->a_x4;
    of_level.link_b_x4 = level->b_x4;
    of_level.vertex_count = level->vertex_count;
    of_level.tile_size = level->tile_size;
    of_level.tile_count = fabric_tiles( level->vertex_count, level->tile_size );
    of_level.slot_count = level->row_count;
    assert_schedule_is_safe( &of_level, &level->schedule, 2, level->link_count, test_link_slot_x4 );
    assert_int_equal( level->row_count, fabric_padded( level->vertex_count + of_level.tile_count ) );
    for ( int i = 0; i < level->row_count; ++i )
    {
        const int32_t slot = level->slot_x4[i] / 4;
        assert_true( i < level->vertex_count ? slot >= 0 && slot < f->vertex_count : slot == f->vertex_count );
    }
    for ( int i = 0; i < WISP_FABRIC_PARENTS * level->finer_row_count; ++i )
    {
        assert_true( level->parent_x4[i] >= 0 && level->parent_x4[i] <= 4 * level->vertex_count );
        assert_true( level->weight[i] >= 0.0f && level->weight[i] <= 1.0f );
    }
    for ( int i = 0; i < 8 * level->chain_begin[level->chain_group_count]; ++i )
    {
        const int32_t slot_x4 = level->chain_x4[i / 8][i % 8];
        assert_true( slot_x4 >= 0 && slot_x4 <= 4 * f->vertex_count );
    }
}

static inline void assert_fabric_is_safe( const wisp_fabric* f )
{
    for ( int i = 0; i < f->level_count; ++i )
    {
        assert_level_is_safe( f, &f->levels[i] );
    }
    for ( int i = 0; i < f->tether_count * f->slot_count; ++i )
    {
        assert_true( f->tether_x4[i] >= 0 && f->tether_x4[i] < 4 * f->slot_count && f->tether_rest[i] >= 0.0f );
    }
    assert_schedule_is_safe( f, &f->link_order, 2, f->link_count, test_link_slot_x4 );
    assert_schedule_is_safe( f, &f->hinge_order, 4, f->hinge_order.slot_count > 0 ? f->hinge_count : 0,
                             test_hinge_slot_x4 );
    for ( int32_t e = 0; e < f->ring_begin[f->ring_slice_count]; ++e )
    {
        for ( int lane = 0; lane < 8; ++lane )
        {
            assert_true( f->ring_x4[e][lane] >= 0 && f->ring_x4[e][lane] < 4 * f->slot_count );
        }
    }
}

static inline int test_compare_longs( const void* a, const void* b )
{
    int64_t x = *(const int64_t*)a, y = *(const int64_t*)b;
    return ( x > y ) - ( x < y );
}

static inline int64_t test_pair( int32_t a, int32_t b )
{
    return ( (int64_t)( a < b ? a : b ) << 32 ) | (int64_t)( a < b ? b : a ) << 1 | ( a < b ? 0 : 1 );
}

/// Edges by sorting all sides of all triangles, and the kind of each by its neighbours in that list.
static inline void assert_edges_are_those_of_the_triangles( const wisp_fabric* f )
{
    int sides = 3 * f->triangle_count, edge = 0, hinges = 0, borders = 0, nonmanifold = 0;
    SCOPED( free_local ) int64_t* side = calloc( (size_t)sides + 1, sizeof( int64_t ) );
    for ( int i = 0; i < sides; ++i )
    {
        side[i] = test_pair( f->triangles[i], f->triangles[i - i % 3 + ( i + 1 ) % 3] );
    }
    qsort( side, (size_t)sides, sizeof( int64_t ), test_compare_longs );
    for ( int i = 0; i < sides; ++edge )
    {
        int uses[2] = { 0, 0 };
        int64_t pair = side[i] >> 1;
        for ( ; i < sides && side[i] >> 1 == pair; ++i )
        {
            uses[side[i] & 1] += 1;
        }
        assert_true( edge < f->edge_count );
        assert_int_equal( f->edges[2 * edge], pair >> 31 );
        assert_int_equal( f->edges[2 * edge + 1], pair & 0x7fffffff );
        hinges += uses[0] == 1 && uses[1] == 1 ? 1 : 0;
        borders += uses[0] + uses[1] == 1 ? 1 : 0;
        nonmanifold += uses[0] > 1 || uses[1] > 1 ? 1 : 0;
    }
    assert_int_equal( edge, f->edge_count );
    assert_int_equal( hinges, f->hinge_count );
    assert_int_equal( borders, f->open_edge_count );
    assert_int_equal( nonmanifold, f->nonmanifold_edge_count );
}

static inline bool test_has_triangle( const wisp_fabric* f, int32_t a, int32_t b, int32_t c )
{
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        for ( int k = 0; k < 3; ++k )
        {
            if ( v[k] == a && v[( k + 1 ) % 3] == b && v[( k + 2 ) % 3] == c )
            {
                return true;
            }
        }
    }
    return false;
}

static inline void assert_hinges_are_two_triangles( const wisp_fabric* f )
{
    // finding a triangle walks all of them, so large meshes are sampled
    int step = 1 + f->hinge_count / 1000;
    for ( int h = 0; h < f->hinge_count; h += step )
    {
        const int32_t* v = f->hinges + 4 * (size_t)h;
        assert_true( test_has_triangle( f, v[0], v[1], v[2] ) );
        assert_true( test_has_triangle( f, v[1], v[0], v[3] ) );
    }
}

static inline void assert_lanes_hold_their_constraints( const wisp_fabric* f, bool bend_links )
{
    // bend links are counted by the hinges whose opposite vertices differ, in order
    int32_t* hinge_of_link = calloc( (size_t)f->link_count + 1, sizeof( int32_t ) );
    int link = f->edge_count;
    for ( int h = 0; h < f->hinge_count && bend_links; ++h )
    {
        if ( f->hinges[4 * h + 2] != f->hinges[4 * h + 3] )
        {
            assert_true( link < f->link_count );
            hinge_of_link[link++] = h;
        }
    }
    assert_int_equal( link, f->link_count );
    for ( int i = 0; i < f->link_order.slot_count; ++i )
    {
        int32_t c = f->link_order.constraint[i];
        assert_int_equal( wisp_fabric_link_kind( f, i ), c < 0 ? -1 : c >= f->edge_count );
        if ( c < 0 )
        {
            assert_true( f->link_rest[i] == 0.0f );
            continue;
        }
        const int32_t* v =
            c < f->edge_count ? f->edges + 2 * (size_t)c : f->hinges + 4 * (size_t)hinge_of_link[c] + 2;
        assert_int_equal( f->link_a_x4[i], 4 * v[0] );
        assert_int_equal( f->link_b_x4[i], 4 * v[1] );
        assert_true( f->link_rest[i] == (float)vec_distance( f->rest[v[0]], f->rest[v[1]] ) );
    }
    for ( int i = 0; i < f->hinge_order.slot_count; ++i )
    {
        for ( int k = 0; k < 4 && f->hinge_order.constraint[i] >= 0; ++k )
        {
            assert_int_equal( test_hinge_slot_x4( f, i, k ), 4 * f->hinges[4 * f->hinge_order.constraint[i] + k] );
        }
    }
    free( hinge_of_link );
}

static inline int64_t test_arrow( int32_t a, int32_t b )
{
    return (int64_t)a << 32 | b;
}

static inline int32_t test_ring_slot( const wisp_fabric* f, int32_t slot, int32_t entry )
{
    int32_t at = f->ring_begin[slot / 8] + entry;
    return at < f->ring_begin[slot / 8 + 1] ? f->ring_x4[at][slot % 8] / 4 : slot;
}

/// The directed edges between the entries around a slot, sorted, against those of its triangles.
/// @param expected [count] sorted here
/// @return the entries up to the last neighbour
static inline int32_t assert_fans_draw( const wisp_fabric* f, int32_t slot, int64_t* expected, int32_t count )
{
    SCOPED( free_local ) int64_t* drawn = calloc( (size_t)count + 1, sizeof( int64_t ) );
    int32_t length = f->ring_begin[slot / 8 + 1] - f->ring_begin[slot / 8], found = 0, used = 0;
    for ( int32_t e = 0; e < length; ++e )
    {
        int32_t a = test_ring_slot( f, slot, e ), b = test_ring_slot( f, slot, e + 1 );
        used = a != slot ? e + 1 : used;
        // no fan is empty or has a single neighbour
        assert_true( a == slot || b != slot || ( e > 0 && test_ring_slot( f, slot, e - 1 ) != slot ) );
        if ( a != slot && b != slot )
        {
            assert_true( found < count );
            drawn[found++] = test_arrow( a, b );
        }
    }
    for ( int32_t e = 0; e + 1 < used; ++e )
    {
        assert_true( test_ring_slot( f, slot, e ) != slot || test_ring_slot( f, slot, e + 1 ) != slot );
    }
    assert_int_equal( found, count );
    qsort( drawn, (size_t)count, sizeof( int64_t ), test_compare_longs );
    qsort( expected, (size_t)count, sizeof( int64_t ), test_compare_longs );
    assert_memory_equal( drawn, expected, (size_t)count * sizeof( int64_t ) );
    return used;
}

/// Around every vertex each triangle occurs once, as two successive neighbours in the user's winding. The other
/// entries are the own slot, and a slice is as long as its longest lane.
static inline void assert_rings_are_those_of_the_triangles( const wisp_fabric* f )
{
    SCOPED( free_local ) int32_t* begin = calloc( (size_t)f->slot_count + 2, sizeof( int32_t ) );
    SCOPED( free_local ) int64_t* arrows = calloc( 3 * (size_t)f->triangle_count + 1, sizeof( int64_t ) );
    for ( int i = 0; i < 3 * f->triangle_count; ++i )
    {
        begin[f->triangles[i] + 2] += 1;
    }
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        begin[slot + 2] += begin[slot + 1];
    }
    for ( int i = 0; i < 3 * f->triangle_count; ++i )
    {
        arrows[begin[f->triangles[i] + 1]++] =
            test_arrow( f->triangles[i - i % 3 + ( i + 1 ) % 3], f->triangles[i - i % 3 + ( i + 2 ) % 3] );
    }
    for ( int slice = 0; slice < f->ring_slice_count; ++slice )
    {
        int32_t longest = 0;
        for ( int slot = slice * 8; slot < slice * 8 + 8; ++slot )
        {
            int32_t used = assert_fans_draw( f, slot, arrows + begin[slot], begin[slot + 1] - begin[slot] );
            longest = used > longest ? used : longest;
        }
        assert_int_equal( f->ring_begin[slice + 1] - f->ring_begin[slice], longest );
    }
}

static inline void assert_slots_are_the_users_vertices( const wisp_fabric* f, const wisp_fabric_def* def )
{
    assert_int_equal( f->vertex_count, def->vertex_count );
    assert_int_equal( f->triangle_count, def->triangle_count );
    assert_int_equal( f->tile_count, ( f->vertex_count + f->tile_size - 1 ) / f->tile_size );
    assert_int_equal( f->slot_count, ( f->vertex_count + f->tile_count + 7 ) / 8 * 8 );
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        int32_t slot = f->vertex_slot[v];
        assert_true( slot >= 0 && slot < f->vertex_count );
        assert_int_equal( f->slot_vertex[slot], v );
        assert_memory_equal( &f->rest[slot], &def->points[v], sizeof( wisp_vec3 ) );
    }
    for ( int s = f->vertex_count; s < f->slot_count; ++s )
    {
        assert_int_equal( f->slot_vertex[s], -1 );
        assert_memory_equal( &f->rest[s], &def->points[0], sizeof( wisp_vec3 ) );
        assert_true( f->area[s] == 0.0f );
    }
    for ( int i = 0; i < 3 * f->triangle_count; ++i )
    {
        assert_int_equal( f->triangles[i], f->vertex_slot[def->triangles[i]] );
    }
}

/// By Heron's formula, which the cooking does not use.
static inline void assert_areas_are_thirds_of_triangles( const wisp_fabric* f )
{
    SCOPED( free_local ) double* area = calloc( (size_t)f->slot_count + 1, sizeof( double ) );
    double largest = 0.0;
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        double a = vec_distance( f->rest[v[0]], f->rest[v[1]] ), b = vec_distance( f->rest[v[1]], f->rest[v[2]] );
        double c = vec_distance( f->rest[v[2]], f->rest[v[0]] ), s = ( a + b + c ) / 2;
        double product = s * ( s - a ) * ( s - b ) * ( s - c ), whole = product > 0.0 ? sqrt( product ) : 0.0;
        largest = whole > largest ? whole : largest;
        for ( int k = 0; k < 3; ++k )
        {
            area[v[k]] += whole / 3;
        }
    }
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        // one rounding to float; Heron loses half the digits of a double where a triangle is thin
        double tolerance = FLT_EPSILON * area[slot] + 1e-7 * largest;
        assert_true( fabs( (double)f->area[slot] - area[slot] ) <= tolerance );
    }
}

/// All properties of a fabric of a mesh.
static inline void assert_fabric_holds( const wisp_fabric* f, const wisp_fabric_def* def )
{
    assert_slots_are_the_users_vertices( f, def );
    assert_areas_are_thirds_of_triangles( f );
    assert_edges_are_those_of_the_triangles( f );
    assert_hinges_are_two_triangles( f );
    assert_lanes_hold_their_constraints( f, def->bend_links );
    assert_rings_are_those_of_the_triangles( f );
    assert_fabric_is_safe( f );
    assert_int_equal( f->hinge_order.slot_count > 0, def->hinges && f->hinge_count > 0 );
}

/// The length of the longest edge.
static inline int test_bandwidth( const wisp_fabric* f )
{
    int widest = 0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        int reach = f->edges[2 * e + 1] - f->edges[2 * e];
        widest = reach > widest ? reach : widest;
    }
    return widest;
}

// ---- memory ----

/// Refuse requests for memory in turn, every `step`-th of them: no fabric is created, and no memory remains.
static inline void assert_no_cook_without_memory( const wisp_fabric_def* def, int64_t step )
{
    bool refused = true;
    for ( int64_t n = 1; refused; n += step )
    {
        test_host host = { 0 };
        wisp_allocator allocator = test_host_allocator( &host );
        wisp_fabric* f = NULL;
        test_host_refuse( &host, n, n % 2 == 0 );
        wisp_status status = wisp_fabric_cook( def, &allocator, &f, NULL );
        refused = test_host_has_refused( &host );
        assert_int_equal( status, refused ? WISP_NO_MEMORY : WISP_OK );
        wisp_fabric_release( f );
        assert_host_memory_is_released( &host );
    }
}
