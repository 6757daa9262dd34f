// Distances along a mesh to its attachments, against geometric values: planes, planes rolled up, spheres.
#include "fabric_planes.h"

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
