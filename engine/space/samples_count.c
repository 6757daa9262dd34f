// First stage: find elements that keep their counts. A kernel decides most in floats, against bounds with a margin
// for rounding. The rest is measured in double precision. Changes are stored aside until their memory is reserved,
// so that a failure leaves the caller's state unchanged.
#include "samples_parts.h"

#include <math.h>
#include <string.h>

// Relative rounding error of floats in the kernel and in the stored bounds.
static const float BOUND_ROUNDING = 4e-6f;
// Half-width of the window of heights, in spacings, where lengths of lines depend on the height.
static const double HEIGHT_WINDOW = 0.05;

// ---- bounds ----

static float above( double lower )
{
    const float f = lower < -1.0 ? -1.0f : ( lower > 1e30 ? 1e30f : (float)lower );
    return f + BOUND_ROUNDING * fabsf( f );
}

static float below( double upper )
{
    const float f = upper > 1e30 ? 1e30f : (float)upper;
    return f - BOUND_ROUNDING * fabsf( f );
}

static void keep_nothing( samples_group* g, int i )
{
    g->lower[i] = 1.0f;
    g->upper[i] = 0.0f;
}

// Returns the length that a count is computed from: the remembered one, as a float, with hysteresis; otherwise the
// current one.
static double counted_from( const wisp_samples_args* args, float remembered, double now )
{
    return args->hysteresis > 0.0f ? (double)remembered : now;
}

static samples_extent triangle_made_from( const samples_update* u, int t, const float* extent,
                                          const samples_extent* now )
{
    return ( samples_extent ){ now->axis, counted_from( u->args, extent[2 * (size_t)t], now->base ),
                               counted_from( u->args, extent[2 * (size_t)t + 1], now->height ) };
}

// Compute bounds of an edge or a triangle from its sampled extents.
static void samples_keep_edge( const samples_update* u, int edge )
{
    samples_group* g = &u->memory->edges;
    double length;
    keep_nothing( g, edge );
    if ( samples_measure_edge( u->args, edge, &length ) )
    {
        const double n = samples_count_of( u->args, counted_from( u->args, g->extent[edge], length ) );
        const samples_bounds b = samples_bounds_of( u->args, n, (double)g->points[edge] );
        g->lower[edge] = above( b.lower );
        g->upper[edge] = below( b.upper );
    }
}

// Bounds the base so that line k keeps its count at every height of the window.
static samples_bounds base_bounds( const samples_lines* lines, samples_bounds window )
{
    const bool merges = lines->args->policy == WISP_SPACING_EVEN && lines->m < 1.0;
    const samples_bounds b = samples_bounds_of( lines->args, merges ? 1.0 : lines->m, lines->points );
    const double least = 1.0 - samples_fraction( lines->args, lines->k, lines->n, window.lower );
    const double most = 1.0 - samples_fraction( lines->args, lines->k, lines->n, window.upper );
    const double lower = b.lower <= 0.0 ? -1.0 : ( least > 0.0 ? b.lower / least : INFINITY );
    return ( samples_bounds ){ lower, most > 0.0 ? b.upper / most : INFINITY };
}

static void samples_keep_triangle( const samples_update* u, int triangle )
{
    samples_group* g = &u->memory->triangles;
    samples_extent now;
    keep_nothing( g, triangle );
    for ( int k = 0; k < 3; ++k )
    {
        const int32_t slot = u->args->triangles[3 * (size_t)triangle + (size_t)( ( g->axis[triangle] + k ) % 3 )];
        u->memory->corner_x4[triangle / 8][k][triangle % 8] = 4 * slot;
    }
    if ( samples_measure_triangle( u->args, triangle, &now ) == false )
    {
        return;
    }
    const samples_extent made = triangle_made_from( u, triangle, g->extent, &now );
    samples_lines lines = samples_lines_of( u->args, &made, &now );
    samples_bounds window = samples_bounds_of( u->args, lines.n, lines.most ), base = { -1.0, INFINITY };
    if ( u->args->policy == WISP_SPACING_EXACT )
    {
        window.lower = fmax( window.lower, now.height - HEIGHT_WINDOW );
        window.upper = fmin( window.upper, now.height + HEIGHT_WINDOW );
    }
    for ( bool more = lines.most > 0.0; more; )
    {
        // the first line without points also bounds the lines above it
        more = samples_next_line( &lines );
        const samples_bounds b = base_bounds( &lines, window );
        base.lower = more ? fmax( base.lower, b.lower ) : base.lower;
        base.upper = fmin( base.upper, b.upper );
        more = more && lines.k < lines.most;
    }
    g->lower[triangle] = above( base.lower );
    g->upper[triangle] = below( base.upper );
    g->low_height[triangle] = above( window.lower );
    g->high_height[triangle] = below( window.upper );
}

// ---- elements ----

static void count_edge( const samples_update* u, int e, samples_counts* counts )
{
    const wisp_samples_args* args = u->args;
    samples_memory* m = u->memory;
    double length, points = 0.0;
    float kept = 0.0f;
    if ( samples_measure_edge( args, e, &length ) == false )
    {
        counts->skipped += 1;
    }
    else if ( !( length <= u->most ) )
    {
        counts->beyond += length;
    }
    else
    {
        kept = args->hysteresis > 0.0f ? args->edge_length[e] : 0.0f;
        if ( args->hysteresis > 0.0f &&
             !( kept > 0.0f && samples_may_stay( args, samples_count_of( args, (double)kept ), length ) ) )
        {
            kept = (float)length;
        }
        points = samples_points_of( args, samples_count_of( args, counted_from( args, kept, length ) ), length );
    }
    m->next[e] = (int32_t)points;
    m->edges.next_extent[e] = kept;
    m->changed[e] = m->needs_resampling || m->next[e] != m->begin[e + 1] - m->begin[e];
    counts->changed += m->changed[e];
    if ( m->changed[e] == 0 )
    {
        args->edge_length[e] = m->edges.extent[e] = kept;
        args->edge_points[e] = m->edges.points[e] = m->next[e];
        samples_keep_edge( u, e );
    }
}

// Bounds a line without points: it, and the lines above it, may get shorter. For even spacing, one part and none
// are the same.
static bool line_stays( const samples_lines* lines )
{
    const bool merges = lines->args->policy == WISP_SPACING_EVEN && lines->m < 1.0;
    return samples_may_stay( lines->args, merges ? 1.0 : lines->m, lines->length ) ||
           ( lines->points == 0.0 && lines->length < 1.0 );
}

static bool triangle_stays( const samples_update* u, const samples_extent* made, const samples_extent* now )
{
    samples_lines lines = samples_lines_of( u->args, made, now );
    bool stays = samples_may_stay( u->args, lines.n, now->height );
    for ( bool more = lines.most > 0.0; more && stays; )
    {
        more = samples_next_line( &lines );
        stays = line_stays( &lines );
        more = more && lines.k < lines.most;
    }
    return stays;
}

// Tests whether the existing recipe has these lines. A line is a run of equal weights of the corner opposite the
// base. Even spacing keeps these weights, so they show the number of parts of the height even where the last lines
// are empty.
static bool has_lines( const samples_update* u, int t, samples_lines lines )
{
    const samples_memory* m = u->memory;
    const int element = m->triangles.first + t, end = m->begin[element + 1],
              across = ( m->triangles.axis[t] + 2 ) % 3;
    int p = m->begin[element];
    while ( samples_next_line( &lines ) )
    {
        const float weight = p < end ? u->from.weights[p][across] : -1.0f;
        if ( u->args->policy == WISP_SPACING_EVEN && weight != (float)lines.fraction )
        {
            return false;
        }
        const int first = p;
        while ( p < end && u->from.weights[p][across] == weight )
        {
            ++p;
        }
        if ( (double)( p - first ) != lines.points )
        {
            return false;
        }
    }
    return p == end;
}

static void commit_triangle( const samples_update* u, int t )
{
    samples_group* g = &u->memory->triangles;
    memcpy( g->extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    memcpy( u->args->triangle_extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    u->args->triangle_axis[t] = g->axis[t] = g->next_axis[t];
    u->args->triangle_points[t] = g->points[t] = u->memory->next[g->first + t];
    samples_keep_triangle( u, t );
}

// Selects the extents that counts are computed from; with hysteresis the previous ones, if they are still allowed.
static void remember_triangle( const samples_update* u, int t, const samples_extent* now, float kept[2] )
{
    const float* before = u->args->triangle_extent + 2 * (size_t)t;
    const samples_extent made = { now->axis, (double)before[0], (double)before[1] };
    const bool has_extent = before[0] > 0.0f && u->args->triangle_axis[t] == now->axis;
    const bool stays = has_extent && triangle_stays( u, &made, now );
    kept[0] = stays ? before[0] : (float)now->base;
    kept[1] = stays ? before[1] : (float)now->height;
}

static void count_triangle( const samples_update* u, int t, samples_counts* counts )
{
    const wisp_samples_args* args = u->args;
    samples_memory* m = u->memory;
    samples_group* g = &m->triangles;
    const int element = g->first + t;
    samples_extent now = { 0 };
    float* kept = g->next_extent + 2 * (size_t)t;
    double points = 0.0;
    bool same = false;
    kept[0] = kept[1] = 0.0f;
    const bool finite = samples_measure_triangle( args, t, &now );
    const double estimate = 0.5 * now.base * now.height;
    if ( finite == false )
    {
        counts->skipped += 1;
        now = ( samples_extent ){ 0 };
        same = m->begin[element + 1] == m->begin[element];
    }
    else if ( !( estimate <= u->most ) )
    {
        counts->beyond += estimate;
    }
    else
    {
        if ( args->hysteresis > 0.0f )
        {
            remember_triangle( u, t, &now, kept );
        }
        const samples_extent made = triangle_made_from( u, t, g->next_extent, &now );
        samples_lines lines = samples_lines_of( args, &made, &now );
        same = now.axis == g->axis[t] && has_lines( u, t, lines );
        while ( samples_next_line( &lines ) )
        {
            points += lines.points;
        }
    }
    m->next[element] = points < (double)INT32_MAX ? (int32_t)points : INT32_MAX;
    g->next_axis[t] = now.axis;
    m->changed[element] = m->needs_resampling || same == false;
    counts->changed += m->changed[element];
    if ( m->changed[element] == 0 )
    {
        commit_triangle( u, t );
    }
}

// ---- blocks ----

static bool is_remembered( const void* state, const void* memory, int begin, int end, size_t row )
{
    return memcmp( (const char*)state + (size_t)begin * row, (const char*)memory + (size_t)begin * row,
                   (size_t)( end - begin ) * row ) == 0;
}

static bool edges_are_remembered( const samples_update* u, int begin, int end )
{
    const samples_group* g = &u->memory->edges;
    return u->memory->needs_resampling == false &&
           is_remembered( u->args->edge_points, g->points, begin, end, sizeof( int32_t ) ) &&
           is_remembered( u->args->edge_length, g->extent, begin, end, sizeof( float ) );
}

static bool triangles_are_remembered( const samples_update* u, int begin, int end )
{
    const samples_group* g = &u->memory->triangles;
    return u->memory->needs_resampling == false &&
           is_remembered( u->args->triangle_points, g->points, begin, end, sizeof( int32_t ) ) &&
           is_remembered( u->args->triangle_axis, g->axis, begin, end, sizeof( int32_t ) ) &&
           is_remembered( u->args->triangle_extent, g->extent, begin, end, 2 * sizeof( float ) );
}

// Marks slices that the kernel has decided. Spacings of the caller are not padded, so their last slice is measured
// instead.
static void mark_unchanged( const samples_update* u, samples_group* g, int begin, int end )
{
    const bool edges = g == &u->memory->edges;
    const float* each = edges ? u->args->edge_spacing : u->args->triangle_spacing;
    const int first = begin / 8, last = each != NULL ? end / 8 : ( end + 7 ) / 8;
    const wisp_extent_args args = {
        .position = u->args->position,
        .pair_x4 = (const int32_t( * )[2][8])u->memory->pair_x4,
        .corner_x4 = (const int32_t( * )[3][8])u->memory->corner_x4,
        .spacing = u->args->spacing,
        .element_spacing = each,
        .lower = g->lower,
        .upper = g->upper,
        .lower_height = g->low_height,
        .upper_height = g->high_height,
        .unchanged = g->held,
    };
    if ( edges ? edges_are_remembered( u, begin, end ) : triangles_are_remembered( u, begin, end ) )
    {
        ( edges ? u->kernels->check_edge_extents : u->kernels->check_triangle_extents )( &args, first, last );
    }
}

static samples_counts count_group( const samples_update* u, samples_group* g, int begin, int end )
{
    samples_memory* m = u->memory;
    samples_counts counts = { 0 };
    memset( g->held + begin / 8, 0, (size_t)( ( end - begin + 7 ) / 8 ) );
    memset( m->changed + g->first + begin, 0, (size_t)( end - begin ) );
    memcpy( m->next + g->first + begin, g->points + begin, (size_t)( end - begin ) * sizeof( int32_t ) );
    mark_unchanged( u, g, begin, end );
    for ( int i = begin; i < end; ++i )
    {
        if ( i % 8 == 0 && g->held[i / 8] == 0xff )
        {
            i += 7;
        }
        else if ( ( g->held[i / 8] >> i % 8 & 1 ) == 0 )
        {
            ( g == &m->edges ? count_edge : count_triangle )( u, i, &counts );
        }
    }
    for ( int i = begin; i < end; ++i )
    {
        counts.points += m->next[g->first + i];
    }
    return counts;
}

void samples_count_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const samples_update* u = context;
    for ( int block = begin; block < end; ++block )
    {
        const bool edges = block < u->edge_blocks;
        samples_group* g = edges ? &u->memory->edges : &u->memory->triangles;
        const int first = ( edges ? block : block - u->edge_blocks ) * SAMPLES_BLOCK;
        const int last = first + SAMPLES_BLOCK < g->count ? first + SAMPLES_BLOCK : g->count;
        u->memory->counts[block] = count_group( u, g, first, last );
    }
}

// ---- fill ----

// Second stage: weights. Elements with unchanged counts keep their weights; the others get new ones. Weights of
// even spacing stay valid until counts change. Weights of exact spacing depend on lengths, so they are computed in
// every update.

static samples_extent made_from( const samples_update* u, int t, const samples_extent* now )
{
    const float* kept = u->memory->triangles.extent + 2 * (size_t)t;
    return u->args->hysteresis > 0.0f ? ( samples_extent ){ now->axis, (double)kept[0], (double)kept[1] } : *now;
}

// ---- weights ----

static void weigh_edge( const samples_update* u, int e, int begin, int end, float ( *weights )[4] )
{
    double length;
    samples_measure_edge( u->args, e, &length );
    for ( int p = begin; p < end; ++p )
    {
        const double fraction = samples_fraction( u->args, p - begin + 1, end - begin + 1, length );
        weights[p][0] = (float)( 1.0 - fraction );
        weights[p][1] = (float)fraction;
        weights[p][2] = weights[p][3] = 0.0f;
    }
}

static void weigh_line( const samples_lines* line, int axis, int first, float ( *weights )[4] )
{
    const int a = axis, b = ( axis + 1 ) % 3, c = ( axis + 2 ) % 3;
    const double q = line->fraction;
    for ( int j = 1; j <= (int)line->points; ++j )
    {
        const double r = samples_fraction( line->args, j, line->m, line->length );
        float* w = weights[first + j - 1];
        w[a] = (float)( ( 1.0 - q ) * ( 1.0 - r ) );
        w[b] = (float)( ( 1.0 - q ) * r );
        w[c] = (float)q;
        w[3] = 0.0f;
    }
}

static void weigh_triangle( const samples_update* u, int t, int begin )
{
    samples_extent now;
    samples_measure_triangle( u->args, t, &now );
    const samples_extent made = made_from( u, t, &now );
    samples_lines line = samples_lines_of( u->args, &made, &now );
    while ( samples_next_line( &line ) )
    {
        weigh_line( &line, now.axis, begin, u->to.weights );
        begin += (int)line.points;
    }
}

void samples_weigh_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const samples_update* u = context;
    const samples_memory* m = u->memory;
    for ( int element = begin; element < end; ++element )
    {
        const int first = m->begin[element], last = m->begin[element + 1], t = element - m->edges.count;
        if ( first == last )
        {
            continue;
        }
        if ( t >= 0 )
        {
            weigh_triangle( u, t, first );
        }
        else
        {
            weigh_edge( u, element, first, last, u->to.weights );
        }
    }
}

// ---- recipes: parents and weights of points ----

static void name_parents( const samples_update* u, int element, const int32_t slots[3], int begin, int end )
{
    static const float NOTHING[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
    const int32_t parents[4] = { 4 * slots[0], 4 * slots[1], 4 * slots[2], 0 }, name = element;
    for ( int p = begin; p < end; ++p )
    {
        memcpy( u->to.parents[p], parents, sizeof( parents ) );
        memcpy( u->to.xyzw + 4 * (size_t)p + 3, &name, sizeof( name ) );
        if ( u->to.normals != NULL )
        {
            memcpy( u->to.normals + 4 * (size_t)p, NOTHING, sizeof( NOTHING ) );
        }
    }
}

static void make_edge( const samples_update* u, int e, int begin, int end )
{
    samples_group* g = &u->memory->edges;
    const int32_t a = u->args->edges[2 * (size_t)e], b = u->args->edges[2 * (size_t)e + 1];
    name_parents( u, e, ( const int32_t[3] ){ a, b, a }, begin, end );
    weigh_edge( u, e, begin, end, u->to.weights );
    u->args->edge_length[e] = g->extent[e] = g->next_extent[e];
    u->args->edge_points[e] = g->points[e] = end - begin;
    samples_keep_edge( u, e );
}

static void make_triangle( const samples_update* u, int t, int begin, int end )
{
    samples_group* g = &u->memory->triangles;
    name_parents( u, g->first + t, u->args->triangles + 3 * (size_t)t, begin, end );
    memcpy( g->extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    memcpy( u->args->triangle_extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    u->args->triangle_axis[t] = g->axis[t] = g->next_axis[t];
    u->args->triangle_points[t] = g->points[t] = end - begin;
    samples_keep_triangle( u, t );
    if ( end > begin )
    {
        weigh_triangle( u, t, begin );
    }
}

// Copies a row of every array; each row has four components.
static void move_points( const samples_update* u, int from, int to, int count )
{
    const size_t bytes = (size_t)count * 4 * sizeof( float );
    if ( count > 0 )
    {
        memcpy( u->to.xyzw + 4 * (size_t)to, u->from.xyzw + 4 * (size_t)from, bytes );
        memcpy( u->to.parents + to, u->from.parents + from, bytes );
        memcpy( u->to.weights + to, u->from.weights + from, bytes );
        if ( u->to.normals != NULL )
        {
            memcpy( u->to.normals + 4 * (size_t)to, u->from.normals + 4 * (size_t)from, bytes );
        }
    }
}

// Converts counts to first points; runs of unchanged elements are copied together.
static void fill_group( const samples_update* u, samples_group* g, int begin, int end, int first_point )
{
    samples_memory* m = u->memory;
    int p = first_point, i = begin;
    while ( i < end )
    {
        const int run = g->first + i, to = p;
        for ( ; i < end && m->changed[g->first + i] == 0; ++i )
        {
            const int count = m->next[g->first + i];
            m->next[g->first + i] = p;
            p += count;
        }
        move_points( u, m->begin[run], to, p - to );
        if ( i < end )
        {
            const int count = m->next[g->first + i];
            m->next[g->first + i] = p;
            ( g == &m->edges ? make_edge : make_triangle )( u, i, p, p + count );
            p += count;
            ++i;
        }
    }
}

void samples_fill_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const samples_update* u = context;
    for ( int block = begin; block < end; ++block )
    {
        const bool edges = block < u->edge_blocks;
        samples_group* g = edges ? &u->memory->edges : &u->memory->triangles;
        const int first = ( edges ? block : block - u->edge_blocks ) * SAMPLES_BLOCK;
        const int last = first + SAMPLES_BLOCK < g->count ? first + SAMPLES_BLOCK : g->count;
        fill_group( u, g, first, last, (int)u->memory->block_begin[block] );
    }
}
