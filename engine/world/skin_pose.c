// Affine transforms, hierarchies of bones, and bones prepared for the kernels of skinning.
#include "alloc.h"
#include "wisp/skin.h"

#include <math.h>
#include <string.h>

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

// The cofactor of entry (r, c).
static double cofactor( const wisp_affine* a, int r, int c )
{
    const int r1 = ( r + 1 ) % 3, r2 = ( r + 2 ) % 3, c1 = ( c + 1 ) % 3, c2 = ( c + 2 ) % 3;
    return (double)a->m[r1][c1] * (double)a->m[r2][c2] - (double)a->m[r1][c2] * (double)a->m[r2][c1];
}

bool wisp_affine_invert( const wisp_affine* a, wisp_affine* out )
{
    double determinant = 0.0, inverse[3][4];
    for ( int c = 0; c < 3; ++c )
    {
        determinant += (double)a->m[0][c] * cofactor( a, 0, c );
    }
    if ( !( determinant != 0.0 ) )
    {
        return false;
    }
    for ( int r = 0; r < 3; ++r )
    {
        inverse[r][3] = 0.0;
        for ( int c = 0; c < 3; ++c )
        {
            inverse[r][c] = cofactor( a, c, r ) / determinant;
            inverse[r][3] -= inverse[r][c] * (double)a->m[c][3];
        }
    }
    const wisp_affine rounded = round_affine( inverse );
    const bool found = is_finite( &rounded );
    *out = found ? rounded : *out;
    return found;
}

wisp_vec3 wisp_affine_apply( const wisp_affine* a, wisp_vec3 p )
{
    float out[3];
    for ( int r = 0; r < 3; ++r )
    {
        out[r] = a->m[r][0] * p.x + a->m[r][1] * p.y + a->m[r][2] * p.z + a->m[r][3];
    }
    return ( wisp_vec3 ){ out[0], out[1], out[2] };
}

wisp_status wisp_compose_bones( int bone_count, const int32_t* parents, const wisp_affine* local, wisp_affine* model,
                                wisp_error* error )
{
    for ( int i = 0; i < bone_count; ++i )
    {
        if ( parents[i] < -1 || parents[i] >= i )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "bone %d: got parent %d, expected -1 or a bone before it", i,
                              parents[i] );
        }
    }
    for ( int i = 0; i < bone_count; ++i )
    {
        model[i] = parents[i] < 0 ? local[i] : wisp_affine_multiply( &model[parents[i]], &local[i] );
    }
    return WISP_OK;
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
