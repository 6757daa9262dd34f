// Skins: checked, sorted by the number of bones of a point, in groups of eight.
#include "wisp/skin.h"

#include "alloc.h"
#include "kernel_tables.h"

#include "wisp/module/definition.h"
#include <math.h>
#include <string.h>

// ---- pose ----

// Affine transforms, hierarchies of bones, and bones prepared for the kernels of skinning.

enum
{
    ROW = 16, // floats of a prepared bone
};

// ---- transforms ----

wisp_affine wisp_affine_identity( void )
{
    return ( wisp_affine ){ { { 1.0f, 0.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 1.0f, 0.0f } } };
}

wisp_affine wisp_affine_from_transform( wisp_transform pose, wisp_vec3 scale )
{
    const double x = (double)pose.rotation.x, y = (double)pose.rotation.y, z = (double)pose.rotation.z,
                 w = (double)pose.rotation.w;
    const double turn[3][3] = {
        { 1.0 - 2.0 * ( y * y + z * z ), 2.0 * ( x * y - w * z ), 2.0 * ( x * z + w * y ) },
        { 2.0 * ( x * y + w * z ), 1.0 - 2.0 * ( x * x + z * z ), 2.0 * ( y * z - w * x ) },
        { 2.0 * ( x * z - w * y ), 2.0 * ( y * z + w * x ), 1.0 - 2.0 * ( x * x + y * y ) },
    };
    const double factor[3] = { (double)scale.x, (double)scale.y, (double)scale.z };
    wisp_affine a = { { { 0.0f, 0.0f, 0.0f, pose.translation.x },
                        { 0.0f, 0.0f, 0.0f, pose.translation.y },
                        { 0.0f, 0.0f, 0.0f, pose.translation.z } } };
    for ( int r = 0; r < 3; ++r )
    {
        for ( int c = 0; c < 3; ++c )
        {
            a.m[r][c] = (float)( turn[r][c] * factor[c] );
        }
    }
    return a;
}

static void multiply( const wisp_affine* a, const wisp_affine* b, double out[3][4] )
{
    for ( int r = 0; r < 3; ++r )
    {
        for ( int c = 0; c < 4; ++c )
        {
            double sum = c == 3 ? (double)a->m[r][3] : 0.0;
            for ( int k = 0; k < 3; ++k )
            {
                sum += (double)a->m[r][k] * (double)b->m[k][c];
            }
            out[r][c] = sum;
        }
    }
}

static wisp_affine round_affine( double m[3][4] )
{
    wisp_affine out;
    for ( int i = 0; i < 12; ++i )
    {
        out.m[i / 4][i % 4] = (float)m[i / 4][i % 4];
    }
    return out;
}

wisp_affine wisp_affine_multiply( const wisp_affine* a, const wisp_affine* b )
{
    double m[3][4];
    multiply( a, b, m );
    return round_affine( m );
}

static bool is_finite( const wisp_affine* a )
{
    bool finite = true;
    for ( int i = 0; i < 12; ++i )
    {
        finite = finite && isfinite( a->m[i / 4][i % 4] );
    }
    return finite;
}

// ---- poses ----

// The largest difference of products of axes from those of a rotation; 2 for a mirror image. NaN stays.
static double rigid_error( double m[3][4] )
{
    double most = 0.0;
    for ( int i = 0; i < 9; ++i )
    {
        const int a = i / 3, b = i % 3;
        const double product = m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b];
        const double error = fabs( product - ( a == b ? 1.0 : 0.0 ) );
        most = error <= most ? most : error;
    }
    const double determinant = m[0][0] * ( m[1][1] * m[2][2] - m[1][2] * m[2][1] ) -
                               m[0][1] * ( m[1][0] * m[2][2] - m[1][2] * m[2][0] ) +
                               m[0][2] * ( m[1][0] * m[2][1] - m[1][1] * m[2][0] );
    return determinant > 0.0 ? most : 2.0;
}

// The unit quaternion of a rotation (Shepperd 1978): the largest of its parts first, so that nothing cancels.
static void find_quaternion( double m[3][4], double q[4] )
{
    const double trace = m[0][0] + m[1][1] + m[2][2];
    const double squares[4] = { m[0][0], m[1][1], m[2][2], trace };
    int largest = 3;
    for ( int i = 0; i < 3; ++i )
    {
        largest = squares[i] > squares[largest] ? i : largest;
    }
    if ( largest == 3 )
    {
        q[0] = m[2][1] - m[1][2], q[1] = m[0][2] - m[2][0], q[2] = m[1][0] - m[0][1], q[3] = 1.0 + trace;
    }
    else
    {
        const int i = largest, j = ( i + 1 ) % 3, k = ( i + 2 ) % 3;
        q[i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
        q[j] = m[i][j] + m[j][i], q[k] = m[i][k] + m[k][i], q[3] = m[k][j] - m[j][k];
    }
    const double scale = 1.0 / sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    for ( int i = 0; i < 4; ++i )
    {
        q[i] *= scale;
    }
}

// The dual part is t q / 2, with the translation t as a quaternion without real part.
static void put_dual_quaternion( double m[3][4], float* row )
{
    double q[4];
    find_quaternion( m, q );
    const double x = 0.5 * m[0][3], y = 0.5 * m[1][3], z = 0.5 * m[2][3];
    const double dual[4] = { x * q[3] + y * q[2] - z * q[1], y * q[3] + z * q[0] - x * q[2],
                             z * q[3] + x * q[1] - y * q[0], -x * q[0] - y * q[1] - z * q[2] };
    for ( int i = 0; i < 4; ++i )
    {
        row[i] = (float)q[i];
        row[4 + i] = (float)dual[i];
    }
}

static void bind( const wisp_skin* skin, const wisp_affine* bones, int b, double out[3][4] )
{
    const wisp_affine identity = wisp_affine_identity();
    multiply( &bones[b], skin->inverse_bind != NULL ? &skin->inverse_bind[b] : &identity, out );
}

static wisp_status check_bones( const wisp_skin* skin, wisp_skin_method method, const wisp_affine* bones,
                                wisp_error* error )
{
    if ( (int)method < 0 || method >= WISP_SKIN_METHOD_COUNT )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "skin: got method %d, which does not exist", (int)method );
    }
    for ( int b = 0; b < skin->bone_count; ++b )
    {
        double m[3][4];
        bind( skin, bones, b, m );
        const wisp_affine rounded = round_affine( m );
        if ( is_finite( &bones[b] ) == false || is_finite( &rounded ) == false )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "bone %d: got a matrix that is not finite", b );
        }
        const double rigid = method == WISP_SKIN_DUAL_QUATERNION ? rigid_error( m ) : 0.0;
        if ( !( rigid <= (double)WISP_SKIN_RIGID_TOLERANCE ) )
        {
            return wisp_fail(
                error, WISP_BAD_INPUT,
                "bone %d: got a matrix that scales, shears or mirrors the bind pose (by %.3g), expected a "
                "rotation and a translation for dual quaternions",
                b, rigid );
        }
    }
    return WISP_OK;
}

wisp_status wisp_skin_pose_set( wisp_skin_pose* pose, const wisp_skin* skin, wisp_skin_method method,
                                const wisp_affine* bones, const wisp_allocator* allocator, wisp_error* error )
{
    wisp_status status = check_bones( skin, method, bones, error );
    const size_t bytes = (size_t)skin->bone_count * ROW * sizeof( float );
    if ( status == WISP_OK && base_buffer_reserve( allocator, &pose->buffer, bytes ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "skin: out of memory for %d bones", skin->bone_count );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    float* rows = pose->buffer.data;
    memset( rows, 0, bytes );
    for ( int b = 0; b < skin->bone_count; ++b )
    {
        double m[3][4];
        bind( skin, bones, b, m );
        if ( method == WISP_SKIN_DUAL_QUATERNION )
        {
            put_dual_quaternion( m, rows + ROW * (size_t)b );
            continue;
        }
        const wisp_affine rounded = round_affine( m );
        memcpy( rows + ROW * (size_t)b, rounded.m, sizeof( rounded.m ) );
    }
    pose->rows = rows;
    pose->method = method;
    pose->bone_count = skin->bone_count;
    return WISP_OK;
}

void wisp_skin_pose_release( wisp_skin_pose* pose, const wisp_allocator* allocator )
{
    if ( pose != NULL )
    {
        base_buffer_release( allocator, &pose->buffer );
        *pose = ( wisp_skin_pose ){ 0 };
    }
}

// ---- skin ----

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
    size_t bytes; // of the block, which this struct begins
} owned_skin;

// The influences of a point: distinct bones, by weight in descending order, then by number.
typedef struct influences
{
    int count;
    int32_t bones[MOST];
    double weights[MOST];
} influences;

// ---- input ----

static const wisp_field SKIN_FIELDS[] = {
    WISP_WHOLE( wisp_skin_def, point_count, 0, 0, MAX_POINTS ),
    WISP_FIELD( wisp_skin_def, bone_count, WISP_FIELD_WHOLE, 1, WISP_SKIN_MAX_BONES, 1, NULL, 0 ),
};
WISP_DEFINE( skin_def, "skin", SKIN_FIELDS )

static wisp_status check_counts( const wisp_skin_def* def, wisp_error* error )
{
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
    wisp_skin_def def;
    int counts[MOST] = { 0 }, begin[MOST + 1] = { 0 };
    wisp_status status = wisp_def_read( &wisp_skin_def_fields, &def, given, error );
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

void wisp_skin_release( wisp_skin* skin )
{
    if ( skin != NULL )
    {
        owned_skin* owned = (owned_skin*)skin;
        const wisp_allocator allocator = owned->allocator;
        base_release( &allocator, owned, owned->bytes );
    }
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
