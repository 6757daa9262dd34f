// Carried motion. In: displacements since the intersection-free positions. Out: for each point the displacement that a
// cut leaves it.
//
// A cut that stopped a point where it was would stop it in space. In the clothes of a figure that jumps, its pinned
// neighbours would then leave it behind, and pass through what it hangs on to. So a point that is cut goes on with the
// pinned points of its participant: with as much of their rigid motion (of least squares) as its own displacement has.
// Where those stand still, or a participant has none, nothing is left.
#include "carried_motion.h"

#include "displacement_limit.h"
#include "predicted_motion.h"

#include <string.h>

// A rigid displacement.
typedef struct rigid_motion
{
    double centre[3];   // m
    double along[3];    // m
    double rotation[3]; // rad
} rigid_motion;

// Sums over pinned points.
typedef struct pinned_sums
{
    int count;
    double place[3], way[3]; // m
} pinned_sums;

static bool is_pinned( const contact_contact_mesh* s, int point )
{
    return s->now[(size_t)point * 4 + 3] == 0.0f;
}

static void way_of( const contact_contact_mesh* s, int point, double out[3] )
{
    for ( size_t k = 0, at = (size_t)point * 4; k < 3; ++k )
    {
        out[k] = (double)( s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k] );
    }
}

static pinned_sums sum_pinned( const contact_contact_mesh* s, const contact_participant* participant )
{
    pinned_sums sums = { 0 };
    for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
    {
        double way[3];
        if ( is_pinned( s, i ) == false )
        {
            continue;
        }
        way_of( s, i, way );
        for ( size_t k = 0; k < 3; ++k )
        {
            sums.place[k] += (double)s->intersection_free[(size_t)i * 4 + k];
            sums.way[k] += way[k];
        }
        sums.count += 1;
    }
    return sums;
}

static void cross( const double a[3], const double b[3], double out[3] )
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// Solve a symmetric 3x3 system by Cramer's rule.
static void solve_symmetric( double m[3][3], const double b[3], double out[3] )
{
    double c[3][3];
    for ( size_t k = 0; k < 3; ++k )
    {
        cross( m[( k + 1 ) % 3], m[( k + 2 ) % 3], c[k] );
    }
    const double det = m[0][0] * c[0][0] + m[0][1] * c[0][1] + m[0][2] * c[0][2];
    for ( size_t k = 0; k < 3; ++k )
    {
        out[k] = ( b[0] * c[0][k] + b[1] * c[1][k] + b[2] * c[2][k] ) / det;
    }
}

// Rotation of least squares: the angular momentum of the pinned points over their inertia. What they do not determine
// (about a line on which all lie) is zero.
static void find_rotation( const contact_contact_mesh* s, const contact_participant* participant,
                           rigid_motion* motion )
{
    static const double REGULARISATION = 1e-6; // of the trace
    double inertia[3][3] = { { 0 } }, momentum[3] = { 0 };
    for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
    {
        if ( is_pinned( s, i ) == false )
        {
            continue;
        }
        double way[3], arm[3], turn[3], squared = 0.0;
        way_of( s, i, way );
        for ( size_t k = 0; k < 3; ++k )
        {
            arm[k] = (double)s->intersection_free[(size_t)i * 4 + k] - motion->centre[k];
            squared += arm[k] * arm[k];
        }
        cross( arm, way, turn );
        for ( size_t k = 0; k < 3; ++k )
        {
            momentum[k] += turn[k];
            for ( size_t l = 0; l < 3; ++l )
            {
                inertia[k][l] += ( k == l ? squared : 0.0 ) - arm[k] * arm[l];
            }
        }
    }
    const double least = REGULARISATION * ( inertia[0][0] + inertia[1][1] + inertia[2][2] );
    for ( size_t k = 0; k < 3; ++k )
    {
        inertia[k][k] += least;
    }
    if ( least > 0.0 )
    {
        solve_symmetric( inertia, momentum, motion->rotation );
    }
}

// @return false if pinned points stand still, or there are none, or all are
static bool find_rigid_motion( const contact_contact_mesh* s, const contact_participant* participant,
                               rigid_motion* motion )
{
    const pinned_sums sums = sum_pinned( s, participant );
    *motion = ( rigid_motion ){ 0 };
    if ( sums.count == 0 || sums.count == participant->point_count )
    {
        return false;
    }
    for ( size_t k = 0; k < 3; ++k )
    {
        motion->centre[k] = sums.place[k] / sums.count;
        motion->along[k] = sums.way[k] / sums.count;
    }
    find_rotation( s, participant, motion );
    const double *a = motion->along, *r = motion->rotation;
    const double size = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    return size > 0.0 && size < INFINITY;
}

// As much of a rigid motion as the point's displacement has, at most all of it.
static void carry( contact_contact_mesh* s, const rigid_motion* motion, int point )
{
    double arm[3], turn[3], way[3], squared = 0.0, along = 0.0;
    for ( size_t k = 0; k < 3; ++k )
    {
        arm[k] = (double)s->intersection_free[(size_t)point * 4 + k] - motion->centre[k];
    }
    cross( motion->rotation, arm, turn );
    way_of( s, point, way );
    for ( size_t k = 0; k < 3; ++k )
    {
        turn[k] += motion->along[k];
        squared += turn[k] * turn[k];
        along += turn[k] * way[k];
    }
    const double part = along > 0.0 ? fmin( 1.0, along / squared ) : 0.0;
    for ( size_t k = 0; k < 3; ++k )
    {
        s->limit->carried[(size_t)point * 4 + k] = (float)( part * turn[k] );
    }
}

void contact_find_carried( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    memset( s->limit->carried, 0, (size_t)s->point_count * 4 * sizeof( float ) );
    s->limit->carries = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        rigid_motion motion;
        const bool is_carried = find_rigid_motion( s, participant, &motion );
        s->limit->carries = s->limit->carries || is_carried;
        for ( int i = 0; i < participant->point_count && is_carried; ++i )
        {
            if ( is_pinned( s, participant->first_point + i ) == false )
            {
                carry( s, &motion, participant->first_point + i );
            }
        }
    }
}
