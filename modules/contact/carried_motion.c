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

#include "wisp/module/inertia.h"

#include <string.h>

// A rigid displacement.
typedef struct rigid_motion
{
    double centre[3];   // m
    double along[3];    // m
    double rotation[3]; // rad
} rigid_motion;

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

static void arm_of( const contact_contact_mesh* s, const rigid_motion* motion, int point, double out[3] )
{
    for ( size_t k = 0; k < 3; ++k )
    {
        out[k] = (double)s->intersection_free[(size_t)point * 4 + k] - motion->centre[k];
    }
}

// Find where the pinned points are and go in the mean. @return how many there are
static int find_mean( const contact_contact_mesh* s, const contact_participant* participant, rigid_motion* motion )
{
    int count = 0;
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
            motion->centre[k] += (double)s->intersection_free[(size_t)i * 4 + k];
            motion->along[k] += way[k];
        }
        count += 1;
    }
    for ( int k = 0; k < 3 && count > 0; ++k )
    {
        motion->centre[k] /= count;
        motion->along[k] /= count;
    }
    return count;
}

// Rotation of least squares: the angular momentum of the pinned points over their inertia.
static void find_rotation( const contact_contact_mesh* s, const contact_participant* participant,
                           rigid_motion* motion )
{
    double inertia[6] = { 0.0 }, momentum[3] = { 0.0 };
    for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
    {
        double way[3], arm[3], turn[3];
        if ( is_pinned( s, i ) == false )
        {
            continue;
        }
        way_of( s, i, way );
        arm_of( s, motion, i, arm );
        wisp_cross_product( arm, way, turn );
        for ( size_t k = 0; k < 3; ++k )
        {
            const double y = arm[( k + 1 ) % 3], z = arm[( k + 2 ) % 3];
            momentum[k] += turn[k];
            inertia[k] += y * y + z * z;
            inertia[5 - k] -= y * z; // yz, xz, xy
        }
    }
    wisp_solve_inertia( inertia, momentum, motion->rotation );
}

// @return false if pinned points stand still, or there are none, or all are
static bool find_rigid_motion( const contact_contact_mesh* s, const contact_participant* participant,
                               rigid_motion* motion )
{
    *motion = ( rigid_motion ){ 0 };
    const int count = find_mean( s, participant, motion );
    if ( count == 0 || count == participant->point_count )
    {
        return false;
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
    arm_of( s, motion, point, arm );
    wisp_cross_product( motion->rotation, arm, turn );
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
    contact_limit* limit = s->limit;
    limit->carries = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        rigid_motion motion;
        if ( find_rigid_motion( s, participant, &motion ) == false )
        {
            continue;
        }
        if ( limit->carries == false )
        {
            memset( limit->carried, 0, (size_t)s->point_count * 4 * sizeof( float ) );
            limit->carries = true;
        }
        for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
        {
            if ( is_pinned( s, i ) == false )
            {
                carry( s, &motion, i );
            }
        }
    }
}
