// Coarse sheets: their vertices, links, chains and parents; on planes, where straight lines are the reference. Tethers:
// distances along a mesh to its attachments, against geometric values: planes, planes rolled up, spheres.
#include "fabric_fixture.h"

/// A plane of any triangulation: `jitter` of a cell, at most 0.24, moves inner vertices, `squash` scales z, diagonals
/// are random when there is jitter.
static test_mesh test_mesh_uneven_plane( int width, int height, float jitter, float squash )
{
    test_mesh mesh = test_mesh_plane( width, height );
    int next = 0;
    for ( int y = 0; y < height && jitter > 0.0f; ++y )
    {
        for ( int x = 0; x < width; ++x )
        {
            int v = y * width + x;
            bool inner_x = x > 0 && x + 1 < width, inner_y = y > 0 && y + 1 < height;
            mesh.points[v].x += inner_x ? test_random_float( v, 3, -jitter, jitter ) : 0.0f;
            mesh.points[v].z += inner_y ? test_random_float( v, 4, -jitter, jitter ) : 0.0f;
            if ( x + 1 < width && y + 1 < height )
            {
                test_mesh_cell( &mesh, &next, v, v + 1, v + width + 1, v + width, test_random( v, 5, 2 ) == 0 );
            }
        }
    }
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].z *= squash;
    }
    return mesh;
}

/// Roll a regular plane about the z axis, so that each cell bends by `angle` and distances along it stay: its flat
/// points become the points of a prism. The flat points are returned, [vertex_count], to be freed.
static wisp_vec3* test_mesh_roll( test_mesh* mesh, double angle )
{
    size_t bytes = (size_t)mesh->vertex_count * sizeof( wisp_vec3 );
    wisp_vec3* flat = checked_malloc( bytes );
    memcpy( flat, mesh->points, bytes );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        double x = 0.0, y = 0.0;
        for ( int cell = 0; cell < (int)flat[v].x; ++cell )
        {
            x += cos( angle * cell );
            y += sin( angle * cell );
        }
        mesh->points[v] = ( wisp_vec3 ){ (float)x, (float)y, flat[v].z };
    }
    return flat;
}

/// Join two meshes; both are freed.
static test_mesh test_mesh_join( test_mesh a, test_mesh b )
{
    test_mesh both = test_mesh_make( a.vertex_count + b.vertex_count, a.triangle_count + b.triangle_count );
    memcpy( both.points, a.points, (size_t)a.vertex_count * sizeof( wisp_vec3 ) );
    memcpy( both.points + a.vertex_count, b.points, (size_t)b.vertex_count * sizeof( wisp_vec3 ) );
    memcpy( both.triangles, a.triangles, 3 * (size_t)a.triangle_count * sizeof( int32_t ) );
    for ( int i = 0; i < 3 * b.triangle_count; ++i )
    {
        both.triangles[3 * a.triangle_count + i] = b.triangles[i] + a.vertex_count;
    }
    test_mesh_free( &a );
    test_mesh_free( &b );
    return both;
}

// Spacing of a level in mean edges, at level 0 of the list.
#define FIRST_SPACING ( 2.0 * 0.72 )

static wisp_fabric* cook_levels( const test_mesh* mesh, const int32_t* attachments, int count )
{
    wisp_fabric_def def = test_fabric_def( mesh );
    def.coarse_sheets = true;
    def.attachments = attachments;
    def.attachment_count = count;
    wisp_fabric* fabric = test_fabric_cook( &def );
    assert_fabric_is_safe( fabric );
    return fabric;
}

static double mean_edge( const wisp_fabric* f )
{
    double sum = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        sum += vec_distance( f->rest[f->edges[2 * e]], f->rest[f->edges[2 * e + 1]] );
    }
    return sum / f->edge_count;
}

static wisp_vec3 rest_of_row( const wisp_fabric* f, const wisp_fabric_level* level, int row )
{
    return f->rest[level->slot_x4[row] / 4];
}

// Slots that a level has.
static bool* members_of( const wisp_fabric* f, int l )
{
    bool* is_member = checked_calloc( (size_t)f->slot_count, sizeof( bool ) );
    for ( int i = 0; i < f->levels[l].vertex_count; ++i )
    {
        is_member[f->levels[l].slot_x4[i] / 4] = true;
    }
    return is_member;
}

static const float* weights_of( const wisp_fabric_level* level, int row )
{
    return level->weight + ( row / 8 * WISP_FABRIC_PARENTS * 8 + row % 8 );
}

static int parent_of( const wisp_fabric_level* level, int row, int k )
{
    return level->parent_x4[( row / 8 * WISP_FABRIC_PARENTS + k ) * 8 + row % 8] / 4;
}

// A chain follows edges of the mesh from one end of its link to the other, and is as long as it says.
static void assert_chain_holds( const wisp_fabric* f, const wisp_fabric_level* level, int lane )
{
    const int group = lane / 8, begin = level->chain_begin[group], end = level->chain_begin[group + 1];
    double length = 0.0;
    assert_int_equal( level->chain_x4[begin][lane % 8], level->slot_x4[level->a_x4[lane] / 4] );
    assert_int_equal( level->chain_x4[end - 1][lane % 8], level->slot_x4[level->b_x4[lane] / 4] );
    for ( int e = begin + 1; e < end; ++e )
    {
        const int32_t a = level->chain_x4[e - 1][lane % 8] / 4, b = level->chain_x4[e][lane % 8] / 4;
        bool is_edge = a == b;
        for ( int k = 0; k < f->edge_count && is_edge == false; ++k )
        {
            is_edge = ( f->edges[2 * k] == a && f->edges[2 * k + 1] == b ) ||
                      ( f->edges[2 * k] == b && f->edges[2 * k + 1] == a );
        }
        assert_true( is_edge );
        length += vec_distance( f->rest[a], f->rest[b] );
    }
    assert_true( fabs( (double)level->chain_rest[lane] - length ) <= 1e-5 * length );
}

// Properties for every mesh: nesting, weights, links and chains. @param all of the chains, or every hundredth
static void assert_levels_hold( const wisp_fabric* f, bool all )
{
    int first_row = 0, first_link = 0;
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = &f->levels[l];
        bool* finer = l > 0 ? members_of( f, l - 1 ) : NULL;
        assert_int_equal( level->first_row, first_row );
        assert_int_equal( level->first_link, first_link );
        first_row += level->row_count;
        first_link += level->schedule.slot_count;
        for ( int i = 0; i < level->vertex_count; ++i )
        {
            assert_true( finer == NULL || finer[level->slot_x4[i] / 4] );
            assert_true( i == 0 || level->slot_x4[i - 1] < level->slot_x4[i] );
        }
        assert_int_equal( level->finer_row_count, l > 0 ? f->levels[l - 1].row_count : f->slot_count );
        int alone = 0;
        for ( int row = 0; row < level->finer_row_count; ++row )
        {
            double sum = 0.0;
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                sum += (double)weights_of( level, row )[8 * k];
            }

            // three roundings of numbers up to one
            assert_true( sum == 0.0 || fabs( sum - 1.0 ) <= 3 * FLT_EPSILON );
            alone += sum == 0.0 ? 1 : 0;
        }
        assert_true( alone >= level->unlinked_count );
        int links = 0;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const bool pads = level->schedule.constraint[i] < 0;
            links += pads ? 0 : 1;
            if ( pads == false )
            {
                const wisp_vec3 a = rest_of_row( f, level, level->a_x4[i] / 4 ),
                                b = rest_of_row( f, level, level->b_x4[i] / 4 );
                assert_true( (double)level->rest[i] >= vec_distance( a, b ) * ( 1.0 - 1e-6 ) );
                assert_true( level->fraction[i] >= 0.05f && level->fraction[i] <= 1.0f );
                if ( all || i % 100 == 0 )
                {
                    assert_chain_holds( f, level, i );
                }
            }
        }
        assert_int_equal( links, level->link_count );
        free( finer );
    }
}

// Rows that a level interpolates to another position, on a flat mesh.
static int wrong_rows( const wisp_fabric* f, int l, double tolerance )
{
    const wisp_fabric_level* level = &f->levels[l];
    int wrong = 0;
    for ( int row = 0; row < ( l > 0 ? f->levels[l - 1].vertex_count : f->vertex_count ); ++row )
    {
        const wisp_vec3 own = l > 0 ? rest_of_row( f, &f->levels[l - 1], row ) : f->rest[row];
        double x = 0.0, z = 0.0;
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const wisp_vec3 p = rest_of_row( f, level, parent_of( level, row, k ) );
            x += (double)weights_of( level, row )[8 * k] * (double)p.x;
            z += (double)weights_of( level, row )[8 * k] * (double)p.z;
        }
        wrong += hypot( x - (double)own.x, z - (double)own.z ) > tolerance ? 1 : 0;
    }
    return wrong;
}

// ---- vertices ----

TEST( a_level_keeps_its_spacing_and_cannot_be_extended )
{
    for ( int kind = 0; kind < 3; ++kind )
    {
        test_mesh mesh = test_mesh_uneven_plane( 53, 49, 0.12f * (float)kind, 1.0f );
        wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
        double spacing = FIRST_SPACING * mean_edge( f );
        assert_int_equal( f->level_count, 2 );
        for ( int l = 0; l < f->level_count; ++l, spacing *= 2.0 )
        {
            bool *own = members_of( f, l ), *finer = l > 0 ? members_of( f, l - 1 ) : NULL;
            for ( int a = 0; a < f->vertex_count; ++a )
            {
                double nearest = 1e30;
                for ( int i = 0; i < f->levels[l].vertex_count; ++i )
                {
                    const int b = f->levels[l].slot_x4[i] / 4;
                    nearest = a == b ? nearest : fmin( nearest, vec_distance( f->rest[a], f->rest[b] ) );
                }

                // lengths are in single precision
                const bool is_finer = finer == NULL || finer[a];
                assert_true( own[a] ? nearest > spacing * 0.99999 : !is_finer || nearest < spacing * 1.00001 );
            }
            free( own );
            free( finer );
        }
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

TEST( levels_end_before_the_motion_is_not_resolved )
{
    const struct
    {
        int side, levels, coarsest;
    } grids[] = { { 17, 0, 0 }, { 24, 0, 0 }, { 33, 1, 289 }, { 65, 2, 289 }, { 129, 3, 289 } };
    for ( int i = 0; i < WISP_COUNT( grids ); ++i )
    {
        test_mesh mesh = test_mesh_plane( grids[i].side, grids[i].side );
        wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
        assert_int_equal( f->level_count, grids[i].levels );
        assert_true( grids[i].levels == 0 || f->levels[f->level_count - 1].vertex_count == grids[i].coarsest );
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

TEST( a_dense_border_of_attachments_does_not_make_a_level_dense )
{
    test_mesh mesh = test_mesh_plane( 48, 48 );
    int32_t border[48];
    for ( int i = 0; i < 48; ++i )
    {
        border[i] = i;
    }
    wisp_fabric* f = cook_levels( &mesh, border, 48 );
    assert_true( f->level_count >= 1 );
    for ( int l = 0, side = 24; l < f->level_count; ++l, side /= 2 )
    {
        assert_in_range( f->levels[l].vertex_count, side * side * 9 / 10, side * side * 5 / 4 + 2 * side );
    }
    assert_levels_hold( f, true );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( large_levels_run_in_tiles_and_small_ones_in_one )
{
    test_mesh mesh = test_mesh_plane( 65, 65 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    const wisp_schedule *finest = &f->levels[0].schedule, *coarsest = &f->levels[1].schedule;
    assert_in_range( finest->tile_count, 4, f->levels[0].link_count / 512 );
    assert_int_equal( coarsest->tile_count, 1 );

    // two workers have work in each colour
    for ( int colour = 0; colour < finest->colour_count; ++colour )
    {
        assert_true( finest->colour_tile[colour + 1] - finest->colour_tile[colour] >= 2 );
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// ---- links ----

// On a grid: every row and column link is whole, and both diagonals of every square are half.
TEST( squares_have_both_diagonals_at_half_of_the_stiffness )
{
    test_mesh mesh = test_mesh_plane( 65, 65 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    for ( int l = 0, side = 33; l < 2; ++l, side = 17 )
    {
        const wisp_fabric_level* level = &f->levels[l];
        int whole = 0, half = 0;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            whole += level->fraction[i] == 1.0f ? 1 : 0;
            half += fabsf( level->fraction[i] - 0.5f ) < 1e-3f ? 1 : 0;
        }
        assert_int_equal( whole, 2 * side * ( side - 1 ) );
        assert_int_equal( half, 2 * ( side - 1 ) * ( side - 1 ) );
        assert_int_equal( level->link_count, whole + half );
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// Euler: a triangulation of v vertices in a disc has 3 v - 3 - b edges. Fractions add up to as many.
TEST( fractions_of_an_irregular_level_add_up_to_a_triangulation )
{
    test_mesh mesh = test_mesh_uneven_plane( 60, 50, 0.24f, 1.0f );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    const wisp_fabric_level* level = &f->levels[0];
    double sum = 0.0;
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        sum += (double)level->fraction[i];
    }
    assert_true( sum > 2.7 * level->vertex_count && sum < 3.05 * level->vertex_count );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( on_planes_links_are_straight_and_rows_are_interpolated_where_they_are )
{
    static const float jitters[] = { 0.0f, 0.1f, 0.24f };
    for ( int i = 0; i < WISP_COUNT( jitters ); ++i )
    {
        test_mesh mesh = test_mesh_uneven_plane( 58, 50, jitters[i], 1.0f );
        const int32_t attachments[] = { 0, 57 };
        wisp_fabric* f = cook_levels( &mesh, attachments, 2 );
        assert_levels_hold( f, true );
        assert_true( f->level_count >= 1 );
        for ( int l = 0; l < f->level_count; ++l )
        {
            const wisp_fabric_level* level = &f->levels[l];
            for ( int k = 0; k < level->schedule.slot_count; ++k )
            {
                const double straight = vec_distance( rest_of_row( f, level, level->a_x4[k] / 4 ),
                                                      rest_of_row( f, level, level->b_x4[k] / 4 ) );
                assert_true( level->schedule.constraint[k] < 0 ||
                             fabs( (double)level->rest[k] - straight ) <= 1e-4 * straight );
            }

            // weights and distances in single precision, up to sixty metres long; rows outside the hull of a jittered border
            assert_in_range( wrong_rows( f, l, 2e-3 ), 0, jitters[i] > 0.0f ? level->vertex_count / 8 : 0 );
        }
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

// ---- other meshes ----

TEST( a_closed_mesh_has_levels_whose_links_follow_it )
{
    test_mesh mesh = test_mesh_sphere( 39, 60 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_true( f->level_count >= 1 );
    assert_levels_hold( f, false );
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = &f->levels[l];
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const double chord = vec_distance( rest_of_row( f, level, level->a_x4[i] / 4 ),
                                               rest_of_row( f, level, level->b_x4[i] / 4 ) );
            const double circle = 2.0 * asin( fmin( 1.0, 0.5 * chord ) );
            assert_true( level->schedule.constraint[i] < 0 ||
                         fabs( (double)level->rest[i] - circle ) <= 0.02 * circle );
        }
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( shells_have_no_links_or_parents_in_common_and_unreferenced_vertices_follow_nothing )
{
    const int count = 30 * 30;
    test_mesh above = test_mesh_plane( 30, 30 );
    for ( int v = 0; v < above.vertex_count; ++v )
    {
        above.points[v].y = 0.1f;
    }
    test_mesh mesh = test_mesh_join( test_mesh_plane( 30, 30 ), above );
    mesh.vertex_count += 1;
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_true( f->level_count >= 1 );
    assert_levels_hold( f, false );
    const wisp_fabric_level* level = &f->levels[0];
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        const int32_t a = f->slot_vertex[level->slot_x4[level->a_x4[i] / 4] / 4],
                      b = f->slot_vertex[level->slot_x4[level->b_x4[i] / 4] / 4];
        assert_true( level->schedule.constraint[i] < 0 || ( a < count ) == ( b < count ) );
    }
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        const int32_t own = f->slot_vertex[slot];
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const bool gives = weights_of( level, slot )[8 * k] > 0.0f;
            const int row = parent_of( level, slot, k );
            assert_true( own < 2 * count || gives == false );
            assert_true( gives == false || ( f->slot_vertex[level->slot_x4[row] / 4] < count ) == ( own < count ) );
        }
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( tiny_and_collapsed_meshes_have_no_levels )
{
    test_mesh meshes[] = { test_mesh_make( 0, 0 ),  test_mesh_make( 1, 0 ), test_mesh_make( 40, 0 ),
                           test_mesh_plane( 2, 2 ), test_mesh_fan( 5 ),     test_mesh_plane( 40, 40 ) };
    for ( int v = 0; v < 1600; ++v )
    {
        meshes[5].points[v] = ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f };
    }
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        wisp_fabric* f = cook_levels( &meshes[i], NULL, 0 );
        assert_int_equal( f->level_count, 0 );
        wisp_fabric_release( f );
        test_mesh_free( &meshes[i] );
    }
}

// A level of these has one vertex of each, and nothing to link.
TEST( loose_squares_have_no_levels )
{
    test_mesh mesh = test_mesh_plane( 2, 2 );
    for ( int i = 1; i < 400; ++i )
    {
        test_mesh square = test_mesh_plane( 2, 2 );
        for ( int v = 0; v < square.vertex_count; ++v )
        {
            square.points[v].y = (float)i;
        }
        mesh = test_mesh_join( mesh, square );
    }
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_int_equal( f->level_count, 0 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( ribbons_fans_books_and_flattened_meshes_hold_too )
{
    test_mesh meshes[] = { test_mesh_plane( 600, 2 ),
                           test_mesh_fan( 900 ),
                           test_mesh_book( 200 ),
                           test_mesh_moebius( 200, 5 ),
                           test_mesh_uneven_plane( 40, 40, 0.2f, 0.05f ),
                           test_mesh_uneven_plane( 40, 40, 0.0f, 1e-5f ),
                           test_mesh_uneven_plane( 40, 40, 0.0f, 0.0f ) };
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        const int32_t attachments[] = { 0, 1 };
        wisp_fabric* f = cook_levels( &meshes[i], attachments, i % 3 );
        assert_levels_hold( f, false );
        assert_true( i != 0 || f->level_count >= 1 );
        wisp_fabric_release( f );
        test_mesh_free( &meshes[i] );
    }
}

TEST( the_same_mesh_has_the_same_levels_bit_for_bit_with_any_number_of_workers )
{
    test_mesh mesh = test_mesh_uneven_plane( 65, 65, 0.2f, 1.0f );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.coarse_sheets = true, def.workers = 3;
    wisp_fabric *alone = cook_levels( &mesh, NULL, 0 ), *shared = test_fabric_cook( &def );
    assert_true( alone->hash == shared->hash && alone->level_count == 2 ); // over every array of every level
    wisp_fabric_release( alone );
    wisp_fabric_release( shared );
    test_mesh_free( &mesh );
}

// ---- memory ----

TEST( levels_without_memory_fail_and_leak_nothing )
{
    static const int sides[] = { 26, 130 };
    for ( int i = 0; i < WISP_COUNT( sides ); ++i )
    {
        const int32_t attachments[] = { 0, 1, 5 };
        test_mesh mesh = test_mesh_plane( sides[i], sides[i] );
        wisp_fabric_def def = test_fabric_def( &mesh );
        def.coarse_sheets = true;
        def.attachments = attachments;
        def.attachment_count = 3;

        // the large one marches over coarse nets; requests of the fabric's other parts are tested on the small one
        assert_no_cook_without_memory( &def, i == 0 ? 1 : 11 );
        test_mesh_free( &mesh );
    }
}

static wisp_fabric* cook_tethers( const test_mesh* mesh, const int32_t* attachments, int count )
{
    wisp_fabric_def def = test_fabric_def( mesh );
    def.tethers = true;
    def.attachments = attachments;
    def.attachment_count = count;
    wisp_fabric* fabric = test_fabric_cook( &def );
    assert_fabric_is_safe( fabric );
    return fabric;
}

static int32_t tether_slot( const wisp_fabric* f, int k, int slot )
{
    return f->tether_x4[(size_t)k * (size_t)f->slot_count + (size_t)slot] / 4;
}

static double tether_rest( const wisp_fabric* f, int k, int slot )
{
    return f->tether_rest[(size_t)k * (size_t)f->slot_count + (size_t)slot];
}

// Distances of a fabric against straight lines between other points, such as those of a flat mesh before it was
// rolled.
// @param flat [vertex_count] by the user's vertex
// @return the largest relative error
static double largest_error( const wisp_fabric* f, const wisp_vec3* flat )
{
    double largest = 0.0;
    for ( int k = 0; k < f->tether_count; ++k )
    {
        for ( int slot = 0; slot < f->vertex_count; ++slot )
        {
            int32_t to = tether_slot( f, k, slot );
            double expected = vec_distance( flat[f->slot_vertex[slot]], flat[f->slot_vertex[to]] );
            double error = fabs( tether_rest( f, k, slot ) - expected ) / ( expected > 0.0 ? expected : 1.0 );
            assert_true( tether_rest( f, k, slot ) >= vec_distance( f->rest[slot], f->rest[to] ) );
            largest = error > largest ? error : largest;
        }
    }
    return largest;
}

// ---- lengths ----

TEST( on_a_plane_of_any_triangulation_a_tether_is_as_long_as_the_straight_line )
{
    static const struct
    {
        int width, height;
        float jitter, squash;
    } planes[] = { { 2, 2, 0.0f, 1.0f },   { 30, 30, 0.0f, 1.0f }, { 60, 40, 0.24f, 1.0f },
                   { 40, 60, 0.2f, 0.3f }, { 50, 3, 0.0f, 4.0f },  { 40, 40, 0.1f, 0.1f } };
    for ( int i = 0; i < WISP_COUNT( planes ); ++i )
    {
        int w = planes[i].width, h = planes[i].height;
        test_mesh mesh = test_mesh_uneven_plane( w, h, planes[i].jitter, planes[i].squash );
        const int32_t attachments[] = { 0, w - 1, w * ( h / 2 ) + w / 2 };
        wisp_fabric* f = cook_tethers( &mesh, attachments, 3 );
        assert_int_equal( f->tether_count, 3 );

        // a march stops correcting at a millionth per triangle, and crosses up to a hundred of them
        assert_true( largest_error( f, mesh.points ) < 1e-4 );
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

TEST( rolling_a_plane_up_changes_no_tether )
{
    static const double angles[] = { 0.02, 0.1, 0.3 };
    for ( int i = 0; i < WISP_COUNT( angles ); ++i )
    {
        test_mesh mesh = test_mesh_plane( 25, 20 );
        wisp_vec3* flat = test_mesh_roll( &mesh, angles[i] );
        const int32_t attachments[] = { 0, 24, 250, 499 };
        wisp_fabric* f = cook_tethers( &mesh, attachments, 4 );

        // points in single precision leave a prism a few parts in ten million from flat
        assert_true( largest_error( f, flat ) < 1e-4 );
        wisp_fabric_release( f );
        free( flat );
        test_mesh_free( &mesh );
    }
}

TEST( on_a_sphere_tethers_follow_great_circles_within_two_percent )
{
    test_mesh mesh = test_mesh_sphere( 39, 60 );
    const int32_t attachments[] = { 0, 1170, mesh.vertex_count - 1 };
    wisp_fabric* f = cook_tethers( &mesh, attachments, 3 );
    for ( int k = 0; k < 3; ++k )
    {
        for ( int slot = 0; slot < f->vertex_count; ++slot )
        {
            double chord = vec_distance( f->rest[slot], f->rest[tether_slot( f, k, slot )] );
            double circle = 2.0 * asin( chord < 2.0 ? 0.5 * chord : 1.0 );
            assert_true( fabs( tether_rest( f, k, slot ) - circle ) <= 0.02 * circle );
            assert_true( tether_rest( f, k, slot ) >= chord );
        }
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// A slit from the right border to the middle: everything behind it is reached around its end.
TEST( a_tether_goes_around_a_slit )
{
    enum
    {
        SIZE = 21,
        MIDDLE = 10
    };
    test_mesh lower = test_mesh_plane( SIZE, MIDDLE + 1 ), upper = test_mesh_plane( SIZE, MIDDLE + 1 );
    for ( int v = 0; v < upper.vertex_count; ++v )
    {
        upper.points[v].z += MIDDLE;
    }
    int first_upper = lower.vertex_count;
    test_mesh mesh = test_mesh_join( lower, upper );
    for ( int i = 0; i < 3 * mesh.triangle_count; ++i )
    {
        int32_t v = mesh.triangles[i] - first_upper;
        mesh.triangles[i] = v >= 0 && v <= MIDDLE ? v + MIDDLE * SIZE : mesh.triangles[i];
    }
    const int32_t attachment = SIZE - 1;
    wisp_fabric* f = cook_tethers( &mesh, &attachment, 1 );
    int32_t behind = f->vertex_slot[first_upper + MIDDLE * SIZE + SIZE - 1];

    // ten columns and ten rows to the end of the slit, and the same back; a bent front is rebuilt from straight ones,
    // so up to a percent may be lost behind the bend, never gained
    double expected = 2.0 * sqrt( 200.0 );
    assert_true( tether_rest( f, 0, behind ) >= expected * ( 1.0 - 1e-6 ) );
    assert_true( tether_rest( f, 0, behind ) <= expected * 1.01 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// ---- which attachments ----

TEST( up_to_eight_attachments_give_the_four_nearest_in_order )
{
    test_mesh mesh = test_mesh_uneven_plane( 30, 30, 0.2f, 1.0f );
    const int32_t attachments[] = { 0, 29, 870, 899, 465, 15, 700, 122 };
    for ( int count = 1; count <= WISP_COUNT( attachments ); ++count )
    {
        wisp_fabric* f = cook_tethers( &mesh, attachments, count );
        assert_int_equal( f->tether_count, count < 4 ? count : 4 );
        assert_true( largest_error( f, mesh.points ) < 1e-4 );
        for ( int slot = 0; slot < f->vertex_count; ++slot )
        {
            double farthest = tether_rest( f, f->tether_count - 1, slot );
            int nearer = 0;
            for ( int i = 0; i < count; ++i )
            {
                double away = vec_distance( f->rest[slot], mesh.points[attachments[i]] );
                nearer += away < farthest * ( 1.0 - 2e-4 ) ? 1 : 0;
            }
            assert_true( nearer < f->tether_count );
            for ( int k = 1; k < f->tether_count; ++k )
            {
                assert_true( tether_rest( f, k, slot ) >= tether_rest( f, k - 1, slot ) );
                assert_true( tether_slot( f, k, slot ) != tether_slot( f, k - 1, slot ) );
            }
        }
        wisp_fabric_release( f );
    }
    test_mesh_free( &mesh );
}

TEST( from_a_pinned_border_come_the_nearest_and_others_spread_along_it )
{
    enum
    {
        SIZE = 64
    };
    test_mesh mesh = test_mesh_plane( SIZE, SIZE );
    int32_t border[SIZE];
    for ( int i = 0; i < SIZE; ++i )
    {
        border[i] = i;
    }
    wisp_fabric* f = cook_tethers( &mesh, border, SIZE );
    assert_int_equal( f->tether_count, 4 );
    assert_true( largest_error( f, mesh.points ) < 0.02 );
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        double depth = f->rest[slot].z, low = SIZE, high = 0.0;
        for ( int k = 0; k < 4; ++k )
        {
            low = fmin( low, f->rest[tether_slot( f, k, slot )].x );
            high = fmax( high, f->rest[tether_slot( f, k, slot )].x );
        }

        // the nearest may be two percent farther than the one straight above
        assert_true( tether_rest( f, 0, slot ) <= depth / 0.98 + 1e-3 );
        assert_true( high - low >= SIZE / 8 );
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( shells_hang_from_their_own_attachments_only )
{
    test_mesh far = test_mesh_plane( 7, 7 ), mesh;
    for ( int v = 0; v < far.vertex_count; ++v )
    {
        far.points[v].y = 0.5f;
    }
    mesh = test_mesh_join( test_mesh_join( test_mesh_plane( 9, 9 ), far ), test_mesh_plane( 5, 5 ) );
    int unreferenced = mesh.vertex_count++;
    const int32_t attachments[] = { 0, 8, 81, 80, unreferenced };
    wisp_fabric* f = cook_tethers( &mesh, attachments, 5 );
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        int v = f->slot_vertex[slot];
        int expected = v < 0 || v == unreferenced ? 0 : v < 81 ? 3 : v < 130 ? 1 : 0;
        int own = 0;
        for ( int k = 0; k < f->tether_count; ++k )
        {
            int32_t to = f->slot_vertex[tether_slot( f, k, slot )];
            bool pads = tether_slot( f, k, slot ) == slot;
            assert_true( pads || ( v < 81 && to < 81 ) || ( v >= 81 && to == 81 ) );
            assert_true( pads == false || tether_rest( f, k, slot ) == 0.0 );
            own += pads ? 0 : 1;
        }
        bool attached = v == 0 || v == 8 || v == 80 || v == 81;
        assert_int_equal( own, expected - ( attached ? 1 : 0 ) );
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

TEST( without_attachments_there_are_no_tethers )
{
    test_mesh mesh = test_mesh_sphere( 7, 8 );
    wisp_fabric* f = cook_tethers( &mesh, NULL, 0 );
    assert_int_equal( f->tether_count, 0 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// ---- difficult meshes for marches ----

TEST( slivers_folds_and_wild_edges_give_lengths_between_the_straight_line_and_the_edges )
{
    test_mesh meshes[] = { test_mesh_book( 9 ), test_mesh_fan( 500 ), test_mesh_moebius( 30, 5 ),
                           test_mesh_uneven_plane( 20, 20, 0.0f, 1e-4f ),
                           test_mesh_uneven_plane( 20, 20, 0.0f, 0.0f ) };
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        const int32_t attachment = meshes[i].vertex_count - 1;
        wisp_fabric* f = cook_tethers( &meshes[i], &attachment, 1 );
        for ( int e = 0; e < f->edge_count; ++e )
        {
            int32_t a = f->edges[2 * e], b = f->edges[2 * e + 1];
            double step = vec_distance( f->rest[a], f->rest[b] ) + 1e-4;
            assert_true( fabs( tether_rest( f, 0, a ) - tether_rest( f, 0, b ) ) <= step );
        }
        for ( int slot = 0; slot < f->vertex_count; ++slot )
        {
            int32_t to = f->vertex_slot[attachment];
            assert_true( tether_rest( f, 0, slot ) >= vec_distance( f->rest[slot], f->rest[to] ) );
        }
        wisp_fabric_release( f );
        test_mesh_free( &meshes[i] );
    }
}

TEST( the_same_mesh_has_the_same_tethers_bit_for_bit )
{
    test_mesh mesh = test_mesh_sphere( 20, 30 );
    int32_t attachments[40];
    for ( int i = 0; i < 40; ++i )
    {
        attachments[i] = 7 * i;
    }
    wisp_fabric *a = cook_tethers( &mesh, attachments, 40 ), *b = cook_tethers( &mesh, attachments, 40 );
    size_t count = (size_t)a->tether_count * (size_t)a->slot_count;
    assert_memory_equal( a->tether_x4, b->tether_x4, count * sizeof( int32_t ) );
    assert_memory_equal( a->tether_rest, b->tether_rest, count * sizeof( float ) );
    wisp_fabric_release( a );
    wisp_fabric_release( b );
    test_mesh_free( &mesh );
}

TEST( tethers_without_memory_fail_and_leak_nothing )
{
    test_mesh mesh = test_mesh_plane( 8, 8 );
    int32_t attachments[20];
    for ( int i = 0; i < 20; ++i )
    {
        attachments[i] = 3 * i;
    }
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.tethers = true;
    def.attachments = attachments;
    def.attachment_count = 20;
    assert_no_cook_without_memory( &def, 1 );
    test_mesh_free( &mesh );
}
