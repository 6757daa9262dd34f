// Weights of the rows of a plate: the energy of each triangle, clamped next to pins and scaled down where it is too stiff.
#include "plate_parts.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Squared cosines below this are rounding errors of right angles: rows of matrices are shorter without.
static const double LEAST_COSINE2 = 1e-12;

static bool is_rigid( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle )
{
    const int32_t* t = f->triangles + 3 * (size_t)triangle;
    return plate->pinned[t[0]] != 0 && plate->pinned[t[1]] != 0 && plate->pinned[t[2]] != 0;
}

// A hinge at a rigid triangle turns on the other side alone. It does not measure the curvature beyond, so it is not part of
// the fit of its neighbours.
void plate_share_turn( const wisp_plate* plate, const wisp_fabric* f, const plate_hinge* h,
                       const int32_t stencil[PLATE_STENCIL], double share[PLATE_STENCIL] )
{
    const bool rigid[2] = { is_rigid( plate, f, h->triangle[0] ), is_rigid( plate, f, h->triangle[1] ) };
    bool whole = true;
    for ( int s = 0; s < PLATE_STENCIL; ++s )
    {
        share[s] = (double)h->fitted[s];
        if ( s > 0 && stencil[s] >= 0 )
        {
            const plate_hinge* next = plate->hinges + stencil[s];
            whole = whole && is_rigid( plate, f, next->triangle[0] ) == false &&
                    is_rigid( plate, f, next->triangle[1] ) == false;
        }
    }
    if ( rigid[0] || rigid[1] || whole == false )
    {
        plate_shape shape;
        memset( share, 0, PLATE_STENCIL * sizeof( double ) );
        share[0] = plate_measure_hinge( f, h, &shape ) ? plate_share_by_height( &shape ) : 0.0;
        share[0] = rigid[0] ? 0.0 : ( rigid[1] ? 1.0 : share[0] );
    }
}

// Energy of turns, 1/2 sum of m d d: m = ( e . e )^2 / ( l l A ) for normals that are as oblique as the edges. Nothing turns
// a triangle about an open edge, so its energy there is the least possible.
void plate_turn_energy( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, double m[3][3] )
{
    const int32_t* t = f->triangles + 3 * (size_t)triangle;
    const double3 e[3] = { plate_edge( f, t[0], t[1] ), plate_edge( f, t[1], t[2] ), plate_edge( f, t[2], t[0] ) };
    const double area = plate_area( f, t );
    for ( int p = 0; p < 3; ++p )
    {
        for ( int q = 0; q < 3; ++q )
        {
            const double cosine = double3_dot( e[p], e[q] );
            const double squares = double3_dot( e[p], e[p] ) * double3_dot( e[q], e[q] ),
                         bottom = sqrt( squares ) * area;
            m[p][q] = cosine * cosine > LEAST_COSINE2 * squares && bottom > 0.0 ? cosine * cosine / bottom : 0.0;
        }
    }
    for ( int open = 0; open < 3; ++open )
    {
        if ( plate->triangle_hinge[triangle][open] >= 0 )
        {
            continue;
        }
        double column[3] = { m[0][open], m[1][open], m[2][open] };
        const double pivot = m[open][open];
        for ( int p = 0; p < 3; ++p )
        {
            for ( int q = 0; q < 3 && pivot > 0.0; ++q )
            {
                m[p][q] -= column[p] * column[q] / pivot;
            }
        }
    }
}

// Energy of one triangle by its items. @param factor turns of its edges from those items
static void patch_matrix( double m[3][3], double factor[3][PLATE_PATCH], int count,
                          double out[PLATE_PATCH][PLATE_PATCH] )
{
    for ( int a = 0; a < count; ++a )
    {
        double moment[3];
        for ( int k = 0; k < 3; ++k )
        {
            moment[k] = m[k][0] * factor[0][a] + m[k][1] * factor[1][a] + m[k][2] * factor[2][a];
        }
        for ( int b = 0; b < count; ++b )
        {
            out[a][b] = moment[0] * factor[0][b] + moment[1] * factor[1][b] + moment[2] * factor[2][b];
        }
    }
}

// Largest row sum of W Q of one triangle.
static double patch_rate( const plate_patch* p, const float* position, double q[PLATE_PATCH][PLATE_PATCH] )
{
    double largest = 0.0;
    for ( int a = 0; a < p->vertex_count; ++a )
    {
        double sum = 0.0;
        for ( int b = 0; b < p->vertex_count; ++b )
        {
            sum += fabs( q[a][b] );
        }
        largest = fmax( largest, sum * (double)position[4 * (size_t)p->vertex[a] + 3] );
    }
    return largest;
}

// Add the energy of a patch to the rows of its items. The own row pads behind the entries of a row; a vertex has no entry of its own.
static void add_patch( plate_row_set* set, uint8_t* place, const int32_t* item, int count,
                       double q[PLATE_PATCH][PLATE_PATCH], double scale )
{
    const int times = set->of_hinges ? 1 : 4;
    for ( int a = 0; a < count; ++a )
    {
        place[set->item_row[item[a]]] = (uint8_t)( a + 1 );
    }
    for ( int a = 0; a < count; ++a )
    {
        const int32_t row = set->item_row[item[a]];
        bool has_own = set->of_hinges == false;
        for ( int32_t n = set->begin[row / 8]; n < set->begin[row / 8 + 1]; ++n )
        {
            const int b = place[plate_other( set, n, row ) / times] - 1;
            if ( b >= 0 && ( b != a || has_own == false ) )
            {
                set->weight[n][row % 8] += (float)( scale * q[a][b] );
                has_own = has_own || b == a;
            }
        }
    }
    for ( int a = 0; a < count; ++a )
    {
        place[set->item_row[item[a]]] = 0;
    }
}

// A row sum of magnitudes: of the weights, and of their sum, the diagonal.
static void bound_rate( wisp_plate* plate, const wisp_fabric* f, const float* position )
{
    const plate_row_set* set = &plate->vertices;
    double largest = 0.0;
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        const int32_t row = set->item_row[v];
        double diagonal = 0.0, magnitudes = 0.0;
        for ( int32_t n = set->begin[row / 8]; n < set->begin[row / 8 + 1]; ++n )
        {
            const double weight = (double)set->weight[n][row % 8];
            diagonal += weight;
            magnitudes += fabs( weight );
        }
        largest = fmax( largest, ( diagonal + magnitudes ) * (double)position[4 * (size_t)v + 3] );
    }
    plate->max_rate = (float)largest;
}

static void clear( wisp_plate* plate )
{
    plate_row_set* sets[2] = { &plate->vertices, &plate->turns };
    for ( int i = 0; i < 2; ++i )
    {
        if ( sets[i]->begin != NULL )
        {
            memset( sets[i]->weight, 0, (size_t)sets[i]->begin[sets[i]->slice_count] * sizeof( sets[i]->weight[0] ) );
        }
    }
}

static void scale_energy( double factor, double m[3][3] )
{
    for ( int k = 0; k < 9; ++k )
    {
        m[k / 3][k % 3] *= factor;
    }
}

static int fill( wisp_plate* plate, const wisp_fabric* fabric, const wisp_plate_input* input )
{
    const float* position = input->position;
    for ( int32_t v = 0; v < fabric->vertex_count; ++v )
    {
        plate->pinned[v] = position[4 * (size_t)v + 3] == 0.0f ? 1 : 0;
    }
    clear( plate );
    plate->largest = 0.0f;
    int lowered = 0;
    for ( int32_t t = 0; t < fabric->triangle_count; ++t )
    {
        if ( is_rigid( plate, fabric, t ) )
        {
            continue;
        }
        double m[3][3], q[PLATE_PATCH][PLATE_PATCH];
        plate_patch p = plate_patch_of( plate, fabric, t );
        plate_turn_energy( plate, fabric, t, m );
        if ( input->factors != NULL )
        {
            scale_energy( (double)input->factors[t], m );
        }
        patch_matrix( m, p.of_vertex, p.vertex_count, q );
        const double rate = patch_rate( &p, position, q ), most = (double)input->max_rate;
        const double scale = rate > most ? most / rate : 1.0;
        lowered += rate > most ? 1 : 0;
        plate->largest = fmaxf( plate->largest, (float)rate );
        // rows sum to zero with their diagonal, so off it the weights of differences are the negative entries
        add_patch( &plate->vertices, plate->place, p.vertex, p.vertex_count, q, -scale );
        if ( plate->turns.begin != NULL )
        {
            patch_matrix( m, p.of_hinge, p.hinge_count, q );
            add_patch( &plate->turns, plate->place, p.hinge, p.hinge_count, q, scale );
        }
    }
    bound_rate( plate, fabric, position );
    return lowered;
}

// Most of the time nothing has changed, so the loop does not look for an end.
static bool has_same_pins( const wisp_plate* plate, const wisp_fabric* fabric, const float* position )
{
    unsigned changed = 0;
    for ( size_t v = 0; v < (size_t)fabric->vertex_count; ++v )
    {
        changed |= plate->pinned[v] ^ ( position[4 * v + 3] == 0.0f ? 1u : 0u );
    }
    return changed == 0;
}

static uint64_t mix( uint64_t key, float value )
{
    uint32_t bits;
    memcpy( &bits, &value, sizeof( bits ) );
    key = ( key ^ bits ) * 0xff51afd7ed558ccdu;
    return key ^ key >> 32;
}

static uint64_t mix_masses( uint64_t key, const wisp_fabric* fabric, const float* position )
{
    for ( size_t v = 0; v < (size_t)fabric->vertex_count; ++v )
    {
        key = mix( key + 1, position[4 * v + 3] );
    }
    return key;
}

wisp_plate* wisp_plate_share( wisp_plate* plate, const wisp_fabric* fabric, const float* position, bool with_turns )
{
    const bool is_whole = plate->fabric == fabric && plate->turns.of_hinges == with_turns && plate->filled &&
                          plate->maps == 0 && plate->scaled_to == FLT_MAX;
    const bool serves = is_whole && plate->masses == mix_masses( 0, fabric, position );
    if ( serves )
    {
        atomic_fetch_add( &plate->owners, 1 );
    }
    return serves ? plate : NULL;
}

// Replace a plate that others have by one alone.
static bool take_alone( wisp_plate** plate, const wisp_fabric* fabric )
{
    wisp_plate *shared = *plate, *own = NULL;
    const bool done = atomic_load( &shared->owners ) == 1 ||
                      wisp_plate_create( fabric, shared->slot_row, 8 * shared->vertices.slice_count,
                                         shared->turns.of_hinges, shared->pool.allocator, &own ) == WISP_OK;
    if ( own != NULL )
    {
        wisp_plate_release( shared, shared->pool.allocator );
        *plate = own;
    }
    return done && plate_list_parts( *plate, fabric );
}

int wisp_plate_update( wisp_plate** plate, const wisp_fabric* fabric, const wisp_plate_input* input )
{
    const wisp_plate* now = *plate;
    const float max_rate = input->max_rate;
    uint64_t key = 0;
    for ( int t = 0; t < fabric->triangle_count && input->factors != NULL; ++t )
    {
        key = mix( key + 1, input->factors[t] );
    }
    key = input->has_mass_map ? mix_masses( key, fabric, input->position ) : key;
    const bool rescaled = max_rate != now->scaled_to && ( now->lowered > 0 || max_rate < now->largest );
    if ( now->filled && key == now->maps && rescaled == false && has_same_pins( now, fabric, input->position ) )
    {
        return now->lowered;
    }
    if ( take_alone( plate, fabric ) == false )
    {
        return -1;
    }
    wisp_plate* own = *plate;
    own->lowered = fill( own, fabric, input );
    own->masses = mix_masses( 0, fabric, input->position );
    own->scaled_to = max_rate;
    own->maps = key;
    own->filled = true;
    plate_release_parts( own );
    return own->lowered;
}
