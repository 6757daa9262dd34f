// Animations sampled and hierarchies multiplied, in double precision (glTF 2.0, sections 3.11 and appendix C).
#include "gltf_internal.h"

#include <math.h>
#include <string.h>

enum
{
    LOCAL = 10, // translation, rotation and scale of a node
};

size_t gltf_pose_work( const gltf_model* model )
{
    return (size_t)model->node_count * ( 12 + LOCAL );
}

void gltf_multiply( const double a[12], const double b[12], double product[12] )
{
    for ( int row = 0; row < 3; ++row )
    {
        for ( int column = 0; column < 4; ++column )
        {
            const double* r = a + 4 * row;
            product[4 * row + column] =
                r[0] * b[column] + r[1] * b[4 + column] + r[2] * b[8 + column] + ( column == 3 ? r[3] : 0.0 );
        }
    }
}

// ---- samplers --------------------------------------------------------------------------------------------------

static int find_key( const double* times, int count, double time )
{
    int low = 0, high = count - 1;
    while ( low < high )
    {
        const int middle = low + ( high - low + 1 ) / 2;
        low = times[middle] <= time ? middle : low;
        high = times[middle] <= time ? high : middle - 1;
    }
    return low;
}

// Spherical, the shorter way (appendix C.4); nearly equal rotations linearly, where the sine has no digits left.
static void slerp( const double* a, const double* b, double t, double* out )
{
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    const double sign = cosine < 0.0 ? -1.0 : 1.0;
    cosine = fmin( fabs( cosine ), 1.0 );
    const double angle = acos( cosine ), sine = sin( angle );
    const bool is_near = sine < 1e-8;
    const double from = is_near ? 1.0 - t : sin( ( 1.0 - t ) * angle ) / sine;
    const double to = sign * ( is_near ? t : sin( t * angle ) / sine );
    for ( int k = 0; k < 4; ++k )
    {
        out[k] = from * a[k] + to * b[k];
    }
}

static double spline( double p, double out_tangent, double in_tangent, double q, double dt, double t )
{
    const double t2 = t * t, t3 = t2 * t;
    return ( 2.0 * t3 - 3.0 * t2 + 1.0 ) * p + dt * ( t3 - 2.0 * t2 + t ) * out_tangent +
           ( -2.0 * t3 + 3.0 * t2 ) * q + dt * ( t3 - t2 ) * in_tangent;
}

void gltf_sample( const gltf_channel* channel, double time, double* out )
{
    const int width = channel->width;
    const int rows = channel->interpolation == GLTF_CUBICSPLINE ? 3 : 1;
    const int key = find_key( channel->times, channel->key_count, time );
    const double* a = channel->values + (size_t)width * ( (size_t)rows * (size_t)key + (size_t)( rows / 2 ) );
    const double* b = a + width * rows;
    const bool is_between = time > channel->times[key] && key + 1 < channel->key_count;
    if ( !is_between || channel->interpolation == GLTF_STEP )
    {
        memcpy( out, a, (size_t)width * sizeof *out );
        return;
    }
    const double dt = channel->times[key + 1] - channel->times[key], t = ( time - channel->times[key] ) / dt;
    if ( channel->interpolation == GLTF_LINEAR && channel->path == GLTF_ROTATION )
    {
        slerp( a, b, t, out );
        return;
    }
    for ( int k = 0; k < width; ++k )
    {
        out[k] = rows == 3 ? spline( a[k], a[width + k], b[k - width], b[k], dt, t ) : a[k] + t * ( b[k] - a[k] );
    }
}

// ---- poses -----------------------------------------------------------------------------------------------------

static void local_matrix( const double* local, double* m )
{
    const double *p = local, *q = local + 3, *s = local + 7;
    const double length = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    const double f = length > 0.0 ? 1.0 / length : 0.0;
    // A spline of rotations may pass through zero: no rotation then.
    const double x = f * q[0], y = f * q[1], z = f * q[2], w = length > 0.0 ? f * q[3] : 1.0;
    const double r[9] = {
        1.0 - 2.0 * ( y * y + z * z ), 2.0 * ( x * y - z * w ),       2.0 * ( x * z + y * w ),
        2.0 * ( x * y + z * w ),       1.0 - 2.0 * ( x * x + z * z ), 2.0 * ( y * z - x * w ),
        2.0 * ( x * z - y * w ),       2.0 * ( y * z + x * w ),       1.0 - 2.0 * ( x * x + y * y )
    };
    for ( int i = 0; i < 12; ++i )
    {
        m[i] = i % 4 == 3 ? p[i / 4] : r[3 * ( i / 4 ) + i % 4] * s[i % 4];
    }
}

const double* gltf_pose_nodes( const gltf_model* model, int animation, double time, double* work )
{
    double* locals = work + 12 * (size_t)model->node_count;
    for ( int n = 0; n < model->node_count; ++n )
    {
        const gltf_node* node = &model->nodes[n];
        double* local = locals + LOCAL * (size_t)n;
        memcpy( local, node->translation, sizeof node->translation );
        memcpy( local + 3, node->rotation, sizeof node->rotation );
        memcpy( local + 7, node->scale, sizeof node->scale );
    }
    const gltf_animation* a = animation >= 0 ? &model->animations[animation] : NULL;
    for ( int c = 0; a != NULL && c < a->channel_count; ++c )
    {
        static const int at[] = { [GLTF_TRANSLATION] = 0, [GLTF_ROTATION] = 3, [GLTF_SCALE] = 7 };
        gltf_sample( &a->channels[c], time, locals + LOCAL * (size_t)a->channels[c].node + at[a->channels[c].path] );
    }
    for ( int i = 0; i < model->node_count; ++i )
    {
        const int n = model->order[i];
        const gltf_node* node = &model->nodes[n];
        double* global = work + 12 * (size_t)n;
        double local[12];
        if ( node->has_matrix )
        {
            memcpy( local, node->matrix, sizeof local );
        }
        else
        {
            local_matrix( locals + LOCAL * (size_t)n, local );
        }
        if ( node->parent >= 0 )
        {
            gltf_multiply( work + 12 * (size_t)node->parent, local, global );
        }
        else
        {
            memcpy( global, local, sizeof local );
        }
    }
    return work;
}

void gltf_pose( const gltf_model* model, int skin, int animation, double time, double* work, double* matrices )
{
    const gltf_skin* s = &model->skins[skin];
    const double* global = gltf_pose_nodes( model, animation, time, work );
    for ( int j = 0; j < s->joint_count; ++j )
    {
        gltf_multiply( global + 12 * (size_t)s->joints[j], s->inverse_bind + 12 * (size_t)j,
                       matrices + 12 * (size_t)j );
    }
}

int gltf_find_animation( const gltf_model* model, const char* animation )
{
    for ( int a = 0; a < model->animation_count; ++a )
    {
        if ( strcmp( model->animations[a].name, animation ) == 0 )
        {
            return a;
        }
    }
    return -1;
}
