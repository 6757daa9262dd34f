// The grid against a naive sort, for any number of workers.
#include "space_fixture.h"

static int cell_of( const wisp_grid* g, const float* quad )
{
    int cell[3];
    for ( int axis = 0; axis < 3; ++axis )
    {
        int c = (int)( ( quad[axis] - g->origin[axis] ) * g->inverse_cell[axis] );
        cell[axis] = c < 0 ? 0 : ( c >= g->dims[axis] ? g->dims[axis] - 1 : c );
    }
    const int *a = g->axis, *d = g->dims;
    return ( cell[a[2]] * d[a[1]] + cell[a[1]] ) * d[a[0]] + cell[a[0]];
}

typedef struct keyed_item
{
    int cell, item;
} keyed_item;

static int by_cell_then_item( const void* a, const void* b )
{
    const keyed_item *l = a, *r = b;
    return l->cell != r->cell ? ( l->cell < r->cell ? -1 : 1 ) : ( l->item > r->item ) - ( l->item < r->item );
}

static void assert_sorted_naively( const wisp_grid* g, const cloud* c )
{
    keyed_item* keys = checked_calloc( (size_t)c->count + 1, sizeof( keyed_item ) );
    for ( int i = 0; i < c->count; ++i )
    {
        keys[i] = ( keyed_item ){ cell_of( g, c->xyzw + 4 * (size_t)i ), i };
    }
    qsort( keys, (size_t)c->count, sizeof( *keys ), by_cell_then_item );
    int cells = g->dims[0] * g->dims[1] * g->dims[2], wrong = g->count != c->count ? 1 : 0;
    for ( int slot = 0; slot < c->count; ++slot )
    {
        const keyed_item key = keys[slot];
        const float* q = c->xyzw + 4 * (size_t)key.item;
        wrong += g->item[slot] != key.item || g->owner[slot] != owner_of( q ) ? 1 : 0;
        wrong += g->x[slot] != q[0] || g->y[slot] != q[1] || g->z[slot] != q[2] ? 1 : 0;
        wrong += slot < g->cell_begin[key.cell] || slot >= g->cell_begin[key.cell + 1] ? 1 : 0;
    }
    for ( int cell = 0; cell < cells; ++cell )
    {
        wrong += g->cell_begin[cell] > g->cell_begin[cell + 1] ? 1 : 0;
    }
    free( keys );
    assert_int_equal( wrong, 0 );
    assert_int_equal( g->cell_begin[0], 0 );
    assert_int_equal( g->cell_begin[cells], c->count );
}

TEST( slots_are_the_items_sorted_by_cell_and_number )
{
    for ( int w = 0; w < WISP_COUNT( WORKER_COUNTS ); ++w )
    {
        space* s = space_open( WORKER_COUNTS[w], baseline() );
        for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
        {
            for ( int i = 0; i < WISP_COUNT( COUNTS ); ++i )
            {
                cloud c = make_cloud( (cloud_shape)shape, COUNTS[i] );
                assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
                assert_sorted_naively( &s->grid, &c );
                free( c.xyzw );
            }
        }
        space_close( s );
    }
}

TEST( many_blocks_of_items_are_sorted_alike )
{
    cloud c = make_cloud( CLOUD_BALL, 30000 );
    for ( int w = 0; w < WISP_COUNT( WORKER_COUNTS ); ++w )
    {
        space* s = space_open( WORKER_COUNTS[w], baseline() );
        s->fine = 1 + w % 4;
        assert_int_equal( build_grid( s, &c, 0.05f ), WISP_OK );
        assert_sorted_naively( &s->grid, &c );
        space_close( s );
    }
    free( c.xyzw );
}

// Distance of an item from its cell, m; rounding may put it there.
static double outside_cell( const wisp_grid* g, const float* quad )
{
    int rest = cell_of( g, quad );
    double most = 0.0;
    for ( int i = 0; i < 3; ++i )
    {
        int axis = g->axis[i], place = rest % g->dims[axis];
        rest /= g->dims[axis];
        double edge = (double)g->cell / ( i == 0 ? g->subdivisions : 1 );
        double lower = (double)g->origin[axis] + place * edge, upper = lower + edge;
        most = fmax( most, fmax( lower - (double)quad[axis], (double)quad[axis] - upper ) );
    }
    return most;
}

TEST( an_item_lies_in_its_cell_or_no_further_off_than_the_slack )
{
    space* s = space_open( 2, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        s->fine = 1 + shape % 4;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        double most = 0.0;
        for ( int i = 0; i < c.count; ++i )
        {
            most = fmax( most, outside_cell( &s->grid, c.xyzw + 4 * (size_t)i ) );
        }
        assert_true( most <= (double)s->grid.rounding_margin );
        free( c.xyzw );
    }
    space_close( s );
}

TEST( cells_are_as_wide_as_requested_unless_there_would_be_too_many )
{
    space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        float requested = cloud_radius( (cloud_shape)shape );
        assert_int_equal( build_grid( s, &c, requested ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_true( g->cell >= requested );
        // four cells per item, and a few that a handful of items may have
        assert_true( (double)g->dims[0] * g->dims[1] * g->dims[2] <= 4.0 * c.count + 64.0 );
        bool sparse = shape == CLOUD_SPREAD || shape == CLOUD_CLUSTERS || shape == CLOUD_LINE;
        assert_int_equal( g->is_widened, sparse );
        free( c.xyzw );
    }
    space_close( s );
}

// Axes with more than one cell come first, the fewest cells fastest.
static int cells_of_rank( const wisp_grid* g, int i )
{
    int cells = g->dims[g->axis[i]];
    return cells > 1 ? cells : INT32_MAX;
}

TEST( the_axis_with_the_fewest_cells_is_the_fastest )
{
    space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 1000 );
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_int_equal( 1 << g->axis[0] | 1 << g->axis[1] | 1 << g->axis[2], 7 );
        assert_true( cells_of_rank( g, 0 ) <= cells_of_rank( g, 1 ) &&
                     cells_of_rank( g, 1 ) <= cells_of_rank( g, 2 ) );
        free( c.xyzw );
    }
    space_close( s );
}

TEST( cells_along_the_fastest_axis_are_cut_unless_there_would_be_too_many )
{
    space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        s->fine = 1;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid cubes = s->grid;
        s->fine = 4;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_memory_equal( g->axis, cubes.axis, sizeof( cubes.axis ) );
        assert_int_equal( g->dims[g->axis[1]], cubes.dims[g->axis[1]] );
        assert_int_equal( g->dims[g->axis[2]], cubes.dims[g->axis[2]] );
        int cut = g->dims[g->axis[0]], whole = cubes.dims[g->axis[0]];
        double rows = (double)g->dims[g->axis[1]] * g->dims[g->axis[2]], most = 4.0 * c.count + 64.0;
        assert_in_range( g->subdivisions, 1, 4 );
        assert_in_range( cut, g->subdivisions * ( whole - 1 ) + 1, g->subdivisions * whole );
        assert_true( rows * cut <= most );
        // a cut less than requested has a reason
        assert_true( g->subdivisions == 4 || rows * ( g->subdivisions + 1 ) * whole > most );
        free( c.xyzw );
    }
    space_close( s );
}

TEST( slots_behind_the_last_may_be_read )
{
    space* s = space_open( 1, baseline() );
    cloud c = make_cloud( CLOUD_BALL, 33 );
    assert_int_equal( build_grid( s, &c, 0.1f ), WISP_OK );
    float sum = 0.0f;
    for ( int slot = 33; slot < 33 + 16; ++slot )
    {
        sum += s->grid.x[slot] + s->grid.y[slot] + s->grid.z[slot];
        sum += (float)( s->grid.item[slot] + s->grid.owner[slot] );
    }
    assert_true( sum == 0.0f ); // and they are never left to chance
    free( c.xyzw );
    space_close( s );
}
