// Skins: checked, sorted by the number of bones of a point, in groups of eight.
#include "wisp/skin.h"

#include "alloc.h"
#include "kernel_tables.h"
#include "wisp/module/definition.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum
{
    MAX_POINTS = 1 << 26,
    LANES = WISP_SKIN_LANES,
    MOST = WISP_SKIN_MAX_INFLUENCES,
};

#define MAX_COORDINATE 1e6f

typedef struct owned_skin
{
    wisp_skin skin; // first: users hold a pointer to it
    wisp_allocator allocator;
    const wisp_kernels* kernels;
    atomic_int owners;
    size_t bytes; // of the block, which this struct begins
} owned_skin;

// The influences of a point: distinct bones, by weight in descending order, then by number.
typedef struct influences
{
    int count;
    int32_t bones[MOST];
    double weights[MOST];
} influences;

void wisp_init_skin_def( wisp_skin_def* def, size_t size )
{
    const wisp_skin_def values = { 0 };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

// ---- input ----

static wisp_status check_counts( const wisp_skin_def* def, wisp_error* error )
{
    if ( def->point_count < 0 || def->point_count > MAX_POINTS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "skin: got %d points, expected 0 to %d", def->point_count,
                          MAX_POINTS );
    }
    if ( def->bone_count < 1 || def->bone_count > WISP_SKIN_MAX_BONES )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "skin: got %d bones, expected 1 to %d", def->bone_count,
                          WISP_SKIN_MAX_BONES );
    }
    if ( def->point_count > 0 && ( def->points == NULL || def->bones == NULL || def->weights == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "skin: got a null list, expected points, bones and weights of %d points",
                          def->point_count );
    }
    for ( int b = 0; b < def->bone_count && def->inverse_bind != NULL; ++b )
    {
        for ( int i = 0; i < 12; ++i )
        {
            if ( !isfinite( def->inverse_bind[b].m[i / 4][i % 4] ) )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "bone %d: got an inverse bind transform that is not finite",
                                  b );
            }
        }
    }
    return WISP_OK;
}

static void insert( influences* found, int32_t bone, double weight )
{
    // take out the weight that the bone has so far, then find the place of the sum
    int at = 0;
    while ( at < found->count && found->bones[at] != bone )
    {
        ++at;
    }
    weight += at < found->count ? found->weights[at] : 0.0;
    found->count += at < found->count ? 0 : 1;
    for ( ; at > 0 && ( found->weights[at - 1] < weight ||
                        ( found->weights[at - 1] <= weight && found->bones[at - 1] > bone ) );
          --at )
    {
        found->weights[at] = found->weights[at - 1];
        found->bones[at] = found->bones[at - 1];
    }
    found->weights[at] = weight;
    found->bones[at] = bone;
}

static wisp_status read_influences( const wisp_skin_def* def, int v, influences* out, wisp_error* error )
{
    *out = ( influences ){ 0 };
    double sum = 0.0;
    for ( int k = 0; k < MOST; ++k )
    {
        const float weight = def->weights[v][k];
        if ( !( weight >= 0.0f && isfinite( weight ) ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "vertex %d: got weight %g, expected a finite number of 0 or more", v, (double)weight );
        }
        if ( weight > 0.0f && ( def->bones[v][k] < 0 || def->bones[v][k] >= def->bone_count ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "vertex %d: got bone %d, but the skin has %d bones", v,
                              def->bones[v][k], def->bone_count );
        }
        if ( weight > 0.0f )
        {
            insert( out, def->bones[v][k], (double)weight );
            sum += (double)weight;
        }
    }
    if ( !( sum > 0.0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "vertex %d: got weights that sum to 0, expected a sum above 0", v );
    }
    for ( int k = 0; k < out->count; ++k )
    {
        out->weights[k] /= sum;
    }
    return WISP_OK;
}

// Checks all points and counts those of each number of influences.
static wisp_status check_points( const wisp_skin_def* def, int counts[MOST], wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int v = 0; v < def->point_count && status == WISP_OK; ++v )
    {
        const wisp_vec3 p = def->points[v];
        influences found;
        // comparisons with NaN are false
        if ( !( fabsf( p.x ) <= MAX_COORDINATE && fabsf( p.y ) <= MAX_COORDINATE && fabsf( p.z ) <= MAX_COORDINATE ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "vertex %d: got (%g, %g, %g), expected finite coordinates within %g m of the origin", v,
                              (double)p.x, (double)p.y, (double)p.z, (double)MAX_COORDINATE );
        }
        status = read_influences( def, v, &found, error );
        counts[status == WISP_OK ? found.count - 1 : 0] += 1;
    }
    return status;
}

// ---- memory ----

static size_t padded( size_t bytes )
{
    return ( bytes + BASE_BUFFER_ALIGNMENT - 1 ) / BASE_BUFFER_ALIGNMENT * BASE_BUFFER_ALIGNMENT;
}

static void* take( char** block, size_t bytes )
{
    void* array = *block;
    *block += padded( bytes );
    return array;
}

typedef struct skin_arrays
{
    int32_t* point;
    float* xyz;
    int32_t ( *bones )[MOST];
    float ( *weights )[MOST];
    wisp_affine* inverse_bind;
} skin_arrays;

static owned_skin* allocate( const wisp_skin_def* def, const wisp_allocator* allocator, size_t slots,
                             skin_arrays* to )
{
    const size_t binds = def->inverse_bind != NULL ? (size_t)def->bone_count * sizeof( wisp_affine ) : 0;
    const size_t bytes = padded( sizeof( owned_skin ) ) + padded( slots * sizeof( int32_t ) ) +
                         padded( slots * 3 * sizeof( float ) ) + padded( slots * sizeof( *to->bones ) ) +
                         padded( slots * sizeof( *to->weights ) ) + padded( binds );
    char* block = base_allocate( allocator, bytes, BASE_BUFFER_ALIGNMENT );
    if ( block == NULL )
    {
        return NULL;
    }
    owned_skin* owned = take( &block, sizeof( owned_skin ) );
    *to = ( skin_arrays ){ .point = take( &block, slots * sizeof( int32_t ) ),
                           .xyz = take( &block, slots * 3 * sizeof( float ) ),
                           .bones = take( &block, slots * sizeof( *to->bones ) ),
                           .weights = take( &block, slots * sizeof( *to->weights ) ) };
    to->inverse_bind = binds > 0 ? take( &block, binds ) : NULL;
    if ( binds > 0 )
    {
        memcpy( to->inverse_bind, def->inverse_bind, binds );
    }
    memset( owned, 0, sizeof( *owned ) );
    owned->allocator = allocator != NULL ? *allocator : ( wisp_allocator ){ 0 };
    owned->bytes = bytes;
    atomic_init( &owned->owners, 1 );
    return owned;
}

// ---- order ----

static void put_point( const wisp_skin_def* def, const skin_arrays* to, int slot, int v, const influences* found )
{
    const int at = slot / LANES * 3 * LANES + slot % LANES;
    to->point[slot] = v;
    to->xyz[at] = def->points[v].x;
    to->xyz[at + LANES] = def->points[v].y;
    to->xyz[at + 2 * LANES] = def->points[v].z;
    for ( int k = 0; k < MOST; ++k )
    {
        to->bones[slot][k] = k < found->count ? found->bones[k] : found->bones[0];
        to->weights[slot][k] = k < found->count ? (float)found->weights[k] : 0.0f;
    }
}

static void put_points( const wisp_skin_def* def, const wisp_skin* skin, const int counts[MOST],
                        const skin_arrays* to )
{
    int next[MOST], end[MOST];
    for ( int k = 0; k < MOST; ++k )
    {
        next[k] = skin->influence_begin[k] * LANES;
        end[k] = next[k] + counts[k];
    }
    for ( int v = 0; v < def->point_count; ++v )
    {
        influences found;
        (void)read_influences( def, v, &found, NULL ); // was checked
        const int kind = found.count - 1;
        put_point( def, to, next[kind]++, v, &found );

        // the last point pads its group
        const int stop = next[kind] == end[kind] ? skin->influence_begin[kind + 1] * LANES : next[kind];
        for ( int slot = next[kind]; slot < stop; ++slot )
        {
            put_point( def, to, slot, v, &found );
        }
    }
}

wisp_status wisp_skin_create( const wisp_skin_def* given, const wisp_allocator* allocator, wisp_skin** out,
                              wisp_error* error )
{
    *out = NULL;
    wisp_skin_def def = wisp_default_skin_def();
    int counts[MOST] = { 0 }, begin[MOST + 1] = { 0 };
    wisp_status status = wisp_def_read( &def, given, "wisp_default_skin_def", error );
    status = status == WISP_OK ? check_counts( &def, error ) : status;
    status = status == WISP_OK ? check_points( &def, counts, error ) : status;
    const wisp_kernels* kernels = status == WISP_OK ? kernels_select( NULL, error ) : NULL;
    if ( kernels == NULL )
    {
        return status == WISP_OK ? WISP_BAD_INPUT : status;
    }
    for ( int k = 0; k < MOST; ++k )
    {
        begin[k + 1] = begin[k] + ( counts[k] + LANES - 1 ) / LANES;
    }
    skin_arrays to = { 0 };
    owned_skin* owned = allocate( &def, allocator, (size_t)begin[MOST] * LANES, &to );
    if ( owned == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "skin: out of memory for %d points", def.point_count );
    }
    wisp_skin* skin = &owned->skin;
    *skin = ( wisp_skin ){ .point_count = def.point_count,
                           .bone_count = def.bone_count,
                           .group_count = begin[MOST],
                           .point = to.point,
                           .xyz = to.xyz,
                           .bones = (const int32_t( * )[MOST])to.bones,
                           .weights = (const float( * )[MOST])to.weights,
                           .inverse_bind = to.inverse_bind };
    memcpy( skin->influence_begin, begin, sizeof( begin ) );
    owned->kernels = kernels;
    put_points( &def, skin, counts, &to );
    *out = skin;
    return WISP_OK;
}

void wisp_skin_retain( wisp_skin* skin )
{
    owned_skin* owned = (owned_skin*)skin;
    if ( owned != NULL )
    {
        atomic_fetch_add_explicit( &owned->owners, 1, memory_order_relaxed );
    }
}

void wisp_skin_release( wisp_skin* skin )
{
    owned_skin* owned = (owned_skin*)skin;

    // acquire: the last reference must see the reads of the others before it frees
    if ( owned != NULL && atomic_fetch_sub_explicit( &owned->owners, 1, memory_order_acq_rel ) == 1 )
    {
        const wisp_allocator allocator = owned->allocator;
        base_release( &allocator, owned, owned->bytes );
    }
}

size_t wisp_skin_bytes( const wisp_skin* skin )
{
    return skin != NULL ? ( (const owned_skin*)skin )->bytes : 0;
}

// ---- points ----

static void skin_all( const wisp_skin* skin, const wisp_skin_pose* pose, wisp_vec3* out )
{
    const wisp_kernels* kernels = ( (const owned_skin*)skin )->kernels;
    wisp_skin_args args = { .xyz = skin->xyz,
                            .point = skin->point,
                            .bones = skin->bones,
                            .weights = skin->weights,
                            .rows = pose->rows,
                            .out = out };
    for ( int k = 0; k < MOST; ++k )
    {
        const int first = skin->influence_begin[k], last = skin->influence_begin[k + 1];
        args.influence_count = k + 1;
        if ( first < last && pose->method == WISP_SKIN_DUAL_QUATERNION )
        {
            kernels->skin_dual_quaternion( &args, first, last );
        }
        else if ( first < last )
        {
            kernels->skin_linear( &args, first, last );
        }
    }
}

wisp_status wisp_skin_points( const wisp_skin* skin, wisp_skin_pose* pose, wisp_skin_method method,
                              const wisp_affine* bones, wisp_vec3* out, wisp_error* error )
{
    WISP_TRY( wisp_skin_pose_set( pose, skin, method, bones, NULL, error ) );
    skin_all( skin, pose, out );
    return WISP_OK;
}
