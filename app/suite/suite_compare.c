#include "suite_compare.h"

#include "wisp/module/collision_mesh.h"
#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- places that two motions have in common ----

// Places of two meshes of one body may lie this far apart, as part of its size: a coarse mesh of a sphere is inside of it.
static const float SAME_PLACE = 0.05f;
// Below this part of the size a place is a vertex.
static const float SAME_VERTEX = 1e-5f;

void suite_match_release( suite_match* match )
{
    free( match->one );
    free( match->other );
    *match = ( suite_match ){ 0 };
}

static float distance_of( wisp_vec3 a, wisp_vec3 b )
{
    const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf( x * x + y * y + z * z );
}

static float size_of( const wisp_vec3* points, int count )
{
    wisp_vec3 low = points[0], high = points[0];
    for ( int i = 1; i < count; ++i )
    {
        low = ( wisp_vec3 ){ fminf( low.x, points[i].x ), fminf( low.y, points[i].y ), fminf( low.z, points[i].z ) };
        high =
            ( wisp_vec3 ){ fmaxf( high.x, points[i].x ), fmaxf( high.y, points[i].y ), fmaxf( high.z, points[i].z ) };
    }
    return distance_of( low, high );
}

static suite_place at_vertex( int vertex )
{
    return ( suite_place ){ { vertex, vertex, vertex }, { 1.0f, 0.0f, 0.0f } };
}

// ---- surfaces ----

// The weights of a point in a triangle: parts of its area.
static suite_place in_triangle( const wisp_vec3* points, const int32_t* corners, wisp_vec3 p )
{
    suite_place place = { { corners[0], corners[1], corners[2] }, { 0 } };
    double areas[3], sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 a = points[corners[( k + 1 ) % 3]], b = points[corners[( k + 2 ) % 3]];
        const double ux = (double)a.x - (double)p.x, uy = (double)a.y - (double)p.y, uz = (double)a.z - (double)p.z;
        const double vx = (double)b.x - (double)p.x, vy = (double)b.y - (double)p.y, vz = (double)b.z - (double)p.z;
        const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
        areas[k] = sqrt( x * x + y * y + z * z );
        sum += areas[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        place.weights[k] = sum > 0.0 ? (float)( areas[k] / sum ) : k == 0 ? 1.0f : 0.0f;
    }
    return place;
}

static suite_place nearest_vertex( const wisp_vec3* points, int count, wisp_vec3 p, float* distance )
{
    int nearest = 0;
    *distance = INFINITY;
    for ( int i = 0; i < count; ++i )
    {
        const float d = distance_of( points[i], p );
        nearest = d < *distance ? i : nearest;
        *distance = fminf( *distance, d );
    }
    return at_vertex( nearest );
}

// Find the places of vertices on a finer mesh. @return the largest distance from it
static float match_surface( const wisp_record_body* fine, const wisp_vec3* fine_points, const wisp_vec3* points,
                            int count, wisp_collision_mesh* mesh, float size, suite_place* out )
{
    float farthest = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        float distance;
        out[i] = nearest_vertex( fine_points, fine->vertex_count, points[i], &distance );
        if ( mesh && distance > SAME_VERTEX * size )
        {
            const wisp_mesh_query query = { .point = points[i], .radius = distance + SAME_VERTEX * size };
            wisp_mesh_nearest found;
            wisp_collision_mesh_closest( mesh, &query, 1, &found, NULL );
            if ( found.triangle >= 0 )
            {
                distance = distance_of( found.point, points[i] );
                out[i] = in_triangle( fine_points, fine->triangles + 3 * (size_t)found.triangle, found.point );
            }
        }
        farthest = fmaxf( farthest, distance );
    }
    return farthest;
}

static wisp_status make_mesh( const wisp_record_body* body, const wisp_vec3* points, wisp_collision_mesh** out,
                              wisp_error* error )
{
    const wisp_collision_mesh_def def = { .points = points,
                                          .triangles = body->triangles,
                                          .point_count = body->vertex_count,
                                          .triangle_count = body->triangle_count,
                                          .deforms = true };
    *out = NULL;
    return body->triangle_count > 0 ? wisp_collision_mesh_create( &def, NULL, out, error ) : WISP_OK;
}

// ---- strands ----

// The place at a part of the length of a strand.
static suite_place on_strand( const wisp_vec3* points, int first, int end, double fraction )
{
    double length = 0.0;
    for ( int i = first + 1; i < end; ++i )
    {
        length += (double)distance_of( points[i - 1], points[i] );
    }
    double left = fraction * length;
    for ( int i = first + 1; i < end; ++i )
    {
        const double segment = (double)distance_of( points[i - 1], points[i] );
        if ( left <= segment || i == end - 1 )
        {
            const float t = segment > 0.0 ? (float)fmin( left / segment, 1.0 ) : 0.0f;
            return ( suite_place ){ { i - 1, i, i }, { 1.0f - t, t, 0.0f } };
        }
        left -= segment;
    }
    return at_vertex( first );
}

static void match_strand( const wisp_vec3* fine_points, int fine_first, int fine_end, const wisp_vec3* points,
                          int first, int end, suite_place* out )
{
    double length = 0.0, along = 0.0;
    for ( int i = first + 1; i < end; ++i )
    {
        length += (double)distance_of( points[i - 1], points[i] );
    }
    for ( int i = first; i < end; ++i )
    {
        along += i > first ? (double)distance_of( points[i - 1], points[i] ) : 0.0;
        const bool is_same = end - first == fine_end - fine_first;
        out[i] = is_same ? at_vertex( fine_first + i - first )
                         : on_strand( fine_points, fine_first, fine_end, length > 0.0 ? along / length : 0.0 );
    }
}

// ---- bodies ----

static wisp_status fail_to_match( const wisp_record_body* body, const char* name, const char* what,
                                  wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: '%s' %s the reference", name, body->name, what );
}

// Find the places of a coarse body's vertices on a fine one, counted within the body.
static wisp_status match_body( const wisp_record_body* coarse, const wisp_vec3* points, const wisp_record_body* fine,
                               const wisp_vec3* fine_points, const char* name, suite_place* out, wisp_error* error )
{
    if ( coarse->strand_count != fine->strand_count )
    {
        return fail_to_match( coarse, name, "has other strands than in", error );
    }
    for ( int s = 0; s < coarse->strand_count; ++s )
    {
        match_strand( fine_points, fine->offsets[s], fine->offsets[s + 1], points, coarse->offsets[s],
                      coarse->offsets[s + 1], out );
    }
    if ( coarse->strand_count > 0 )
    {
        return WISP_OK;
    }
    wisp_collision_mesh* mesh;
    WISP_TRY( make_mesh( fine, fine_points, &mesh, error ) );
    const float size = size_of( points, coarse->vertex_count );
    const float farthest = match_surface( fine, fine_points, points, coarse->vertex_count, mesh, size, out );
    wisp_collision_mesh_release( mesh );
    return farthest <= SAME_PLACE * size ? WISP_OK : fail_to_match( coarse, name, "starts elsewhere than in", error );
}

static void shift( suite_place* places, int count, int first )
{
    for ( int i = 0; i < count; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            places[i].vertices[k] += first;
        }
    }
}

static int find_body( const suite_motion* motion, const char* name )
{
    for ( int i = 0; i < motion->body_count; ++i )
    {
        if ( strcmp( motion->bodies[i].name, name ) == 0 )
        {
            return i;
        }
    }
    return -1;
}

wisp_status suite_match_motions( const suite_motion* one, const suite_motion* other, const char* name,
                                 suite_match* out, wisp_error* error )
{
    *out = ( suite_match ){ 0 };
    const int n = suite_motion_points( one ), m = suite_motion_points( other );
    const size_t most = (size_t)( n < m ? m : n ) + 1;
    out->one = calloc( most, sizeof *out->one );
    out->other = calloc( most, sizeof *out->other );
    wisp_status status =
        out->one && out->other ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory to match %d points", n );
    for ( int b = 0; b < one->body_count && status == WISP_OK; ++b )
    {
        const int c = find_body( other, one->bodies[b].name );
        if ( c < 0 )
        {
            continue;
        }
        const wisp_record_body *x = &one->bodies[b], *y = &other->bodies[c];
        const bool is_one = x->vertex_count <= y->vertex_count;
        const wisp_vec3 *p = one->start + one->first[b], *q = other->start + other->first[c];
        suite_place *on_one = out->one + out->count, *on_other = out->other + out->count;
        const int count = is_one ? x->vertex_count : y->vertex_count;
        status =
            is_one ? match_body( x, p, y, q, name, on_other, error ) : match_body( y, q, x, p, name, on_one, error );
        for ( int i = 0; i < count; ++i )
        {
            *( is_one ? on_one + i : on_other + i ) = at_vertex( i );
        }
        shift( on_one, count, one->first[b] );
        shift( on_other, count, other->first[c] );
        out->count += count;
    }
    return status != WISP_OK || out->count > 0
               ? status
               : wisp_fail( error, WISP_BAD_INPUT, "%s: it has no body of the reference", name );
}

static void take_place( const suite_place* place, const wisp_vec3* points, double out[3] )
{
    out[0] = out[1] = out[2] = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 p = points[place->vertices[k]];
        out[0] += (double)place->weights[k] * (double)p.x;
        out[1] += (double)place->weights[k] * (double)p.y;
        out[2] += (double)place->weights[k] * (double)p.z;
    }
}

static void take_difference( const suite_match* match, int place, const suite_motion* one, const suite_motion* other,
                             int frame, double out[3] )
{
    double subtracted[3];
    take_place( match->one + place, one->points + (size_t)frame * (size_t)suite_motion_points( one ), out );
    take_place( match->other + place, other->points + (size_t)frame * (size_t)suite_motion_points( other ),
                subtracted );
    for ( int k = 0; k < 3; ++k )
    {
        out[k] -= subtracted[k];
    }
}

double suite_motion_size( const suite_motion* motion )
{
    return (double)size_of( motion->start, suite_motion_points( motion ) );
}

double suite_distance( const suite_match* match, const suite_motion* one, const suite_motion* other, int first_frame,
                       int frame_count, double* most )
{
    double sum = 0.0, largest = 0.0;
    for ( int frame = first_frame; frame < first_frame + frame_count; ++frame )
    {
        for ( int i = 0; i < match->count; ++i )
        {
            double d[3];
            take_difference( match, i, one, other, frame, d );
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            sum += square;
            largest = fmax( largest, square );
        }
    }
    if ( most )
    {
        *most = sqrt( largest );
    }
    return sqrt( sum / ( (double)frame_count * match->count ) );
}

// Mean height of all places above those of another motion, against gravity.
static double compare_height( const suite_match* match, const suite_motion* one, const suite_motion* other,
                              wisp_vec3 gravity, int first, int count )
{
    const double g[3] = { (double)gravity.x, (double)gravity.y, (double)gravity.z };
    double sum = 0.0;
    for ( int i = 0; i < count * match->count; ++i )
    {
        double d[3];
        take_difference( match, i % match->count, one, other, first + i / match->count, d );
        sum -= d[0] * g[0] + d[1] * g[1] + d[2] * g[2];
    }
    return sum / ( (double)count * match->count * sqrt( g[0] * g[0] + g[1] * g[1] + g[2] * g[2] ) );
}

double suite_drift( const suite_motion* motion )
{
    const size_t n = (size_t)suite_motion_points( motion );
    double sum = 0.0;
    for ( size_t i = 0; i < n * (size_t)motion->frame_count; ++i )
    {
        const double d = (double)distance_of( motion->points[i], motion->start[i % n] );
        sum += d * d;
    }
    return sqrt( sum / ( (double)n * motion->frame_count ) );
}

// Recordings keep times as multiples of a step in single precision.
static const double SAME_MOMENT = 1e-5; // s

// ---- detail ----

// Sums over the triangles around a vertex.
typedef struct vertex_fan
{
    double sum[3];    // of the next corners
    double normal[3]; // twice the area
    int64_t turn;     // numbers of the next corners less those of the corners before
    int count;
} vertex_fan;

static void add_triangle( const wisp_vec3* points, const int32_t* corners, vertex_fan* fans )
{
    double p[3][3];
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 v = points[corners[k]];
        p[k][0] = (double)v.x;
        p[k][1] = (double)v.y;
        p[k][2] = (double)v.z;
    }
    double normal[3];
    for ( int i = 0; i < 3; ++i )
    {
        const int j = ( i + 1 ) % 3, k = ( i + 2 ) % 3;
        normal[i] = ( p[1][j] - p[0][j] ) * ( p[2][k] - p[0][k] ) - ( p[1][k] - p[0][k] ) * ( p[2][j] - p[0][j] );
    }
    for ( int k = 0; k < 3; ++k )
    {
        vertex_fan* fan = &fans[corners[k]];
        const int next = ( k + 1 ) % 3;
        for ( int i = 0; i < 3; ++i )
        {
            fan->sum[i] += p[next][i];
            fan->normal[i] += normal[i];
        }
        fan->turn += (int64_t)corners[next] - corners[( k + 2 ) % 3];
        ++fan->count;
    }
}

// The squared normal part of a vertex's Laplacian. Around an inner vertex every neighbour is once the next corner of a triangle and once
// the one before, so both sums of their numbers are the same; around one of the border they are not.
static double square_of( const vertex_fan* fan, wisp_vec3 point )
{
    const double p[3] = { (double)point.x, (double)point.y, (double)point.z };
    double along = 0.0, length = 0.0;
    if ( fan->count == 0 || fan->turn != 0 )
    {
        return 0.0;
    }
    for ( int i = 0; i < 3; ++i )
    {
        along += ( fan->sum[i] / fan->count - p[i] ) * fan->normal[i];
        length += fan->normal[i] * fan->normal[i];
    }
    return length > 0.0 ? along * along / length : 0.0;
}

// @param fans [vertices of the body] buffer
static double curvature_of( const wisp_record_body* body, const wisp_vec3* points, vertex_fan* fans )
{
    double sum = 0.0;
    memset( fans, 0, (size_t)body->vertex_count * sizeof *fans );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        add_triangle( points, body->triangles + 3 * (size_t)t, fans );
    }
    for ( int i = 0; i < body->vertex_count; ++i )
    {
        sum += square_of( fans + i, points[i] );
    }
    return sum;
}

static bool is_same_mesh( const wisp_record_body* a, const wisp_record_body* b )
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           ( a->triangle_count == 0 ||
             memcmp( a->triangles, b->triangles, 3 * (size_t)a->triangle_count * sizeof *a->triangles ) == 0 );
}

// The total length of a body's edges, each as often as it has triangles, and segments.
static double lengths_of( const wisp_record_body* body, const wisp_vec3* points, vertex_fan* unused )
{
    double sum = 0.0;
    (void)unused;
    for ( int k = 0; k < 3 * body->triangle_count; ++k )
    {
        const int next = k % 3 == 2 ? k - 2 : k + 1;
        sum += (double)distance_of( points[body->triangles[k]], points[body->triangles[next]] );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s] + 1; v < body->offsets[s + 1]; ++v )
        {
            sum += (double)distance_of( points[v - 1], points[v] );
        }
    }
    return sum;
}

typedef double of_body( const wisp_record_body* body, const wisp_vec3* points, vertex_fan* fans );

static double sum_over( const suite_motion* motion, int first, int count, of_body* of, vertex_fan* fans )
{
    const size_t n = (size_t)suite_motion_points( motion );
    double sum = 0.0;
    for ( int frame = first; frame < first + count; ++frame )
    {
        for ( int b = 0; b < motion->body_count; ++b )
        {
            sum += of( &motion->bodies[b], motion->points + (size_t)frame * n + motion->first[b], fans );
        }
    }
    return sum;
}

// @return NaN: meshes differ, or the reference has none of it
static double ratio_of( const suite_motion* motion, const suite_motion* reference, int first, int count, of_body* of )
{
    bool is_same = motion->body_count == reference->body_count;
    for ( int b = 0; b < motion->body_count && is_same; ++b )
    {
        is_same = is_same_mesh( &motion->bodies[b], &reference->bodies[b] );
    }
    const size_t n = (size_t)suite_motion_points( motion ) + 1;
    vertex_fan* fans = is_same ? malloc( n * sizeof *fans ) : NULL;
    const double sum = fans ? sum_over( reference, first, count, of, fans ) : 0.0;
    const double ratio = sum > 0.0 ? sum_over( motion, first, count, of, fans ) / sum : NAN;
    free( fans );
    return ratio;
}

double suite_detail( const suite_motion* motion, const suite_motion* reference, int first_frame, int frame_count )
{
    return sqrt( ratio_of( motion, reference, first_frame, frame_count, curvature_of ) );
}

// ---- energy ----

static double total( const suite_motion* motion, int frame )
{
    return (double)motion->energies[frame].x + (double)motion->energies[frame].y;
}

// Mean over some frames, in parts of the most that the reference has released until then: where it swings up again little is left.
// Where inputs bring it more than it releases, what is released is no scale.
static double compare_energy( const suite_motion* motion, const suite_motion* reference, int first, int count )
{
    double released = 0.0, gained = 0.0, risen = 0.0;
    for ( int frame = 0; frame < first + count; ++frame )
    {
        released = fmax( released, (double)reference->energies[0].y - (double)reference->energies[frame].y );
        risen = fmax( risen, total( reference, frame ) - total( reference, 0 ) );
        gained += frame >= first ? total( motion, frame ) - total( reference, frame ) : 0.0;
    }
    return released > risen ? gained / ( count * released ) : NAN;
}

// ---- all ----

static int frame_at( const suite_motion* motion, double moment, int frame_count )
{
    for ( int frame = 0; frame < frame_count; ++frame )
    {
        if ( fabs( motion->times[frame] - moment ) <= SAME_MOMENT )
        {
            return frame;
        }
    }
    return -1;
}

wisp_status suite_compare( const suite_motion* motion, const suite_reference* reference, const char* name,
                           suite_comparison* out, wisp_error* error )
{
    const suite_motion* other = &reference->motion;
    const int count = reference->frame_count, late = other->frame_count - count;
    suite_match match = { 0 };
    *out = suite_not_compared;
    const wisp_status status = suite_match_motions( motion, other, name, &match, error );
    if ( status == WISP_OK )
    {
        out->distance = suite_distance( &match, motion, other, 0, count, &out->largest );
        out->detail = suite_detail( motion, other, 0, count );
        out->energy = compare_energy( motion, other, count - 1, 1 );
    }
    if ( status == WISP_OK && late > 0 )
    {
        out->late_height = compare_height( &match, motion, other, reference->gravity, count, late );
        out->late_energy = compare_energy( motion, other, count, late );
        out->late_stretch = ratio_of( motion, other, count, late, lengths_of ) - 1.0;
        out->late_detail = suite_detail( motion, other, count, late );
    }
    for ( int i = 0; i < SUITE_MOMENT_COUNT && status == WISP_OK; ++i )
    {
        const int frame = frame_at( other, suite_moments[i], count );
        out->at[i] = frame >= 0 ? suite_distance( &match, motion, other, frame, 1, NULL ) : NAN;
    }
    suite_match_release( &match );
    return status;
}
