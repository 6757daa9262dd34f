// Sharp folds of cloth whose bending is by links between opposite vertices. Where such a link is shorter than half its rest
// length, its hinge is bent in its place: by the angle between its triangles, which has a direction even in a flat fold.
#include "passes_common.h"

#include "wisp/module/components.h"

#include <math.h>
#include <string.h>

// Passes without a search after one that found no sharp folds: with a search links take a tenth longer.
#define PASSES_BETWEEN 7

static wisp_vec3 from( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ b.x - a.x, b.y - a.y, b.z - a.z };
}

static float square( wisp_vec3 v )
{
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

static float area( wisp_vec3 a, wisp_vec3 b )
{
    const wisp_vec3 n = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    return 0.5f * sqrtf( square( n ) );
}

// The energy of an angle t is 1/2 B e^2 t^2 / A, with rigidity B, edge e and the area A of both triangles.
static float compliance_of( const wisp_fabric* fabric, const int32_t* corner, float rigidity )
{
    const wisp_vec3 i = fabric->rest[corner[0]], edge = from( i, fabric->rest[corner[1]] );
    const float both =
        area( edge, from( i, fabric->rest[corner[2]] ) ) + area( edge, from( i, fabric->rest[corner[3]] ) );
    return both / ( rigidity * fmaxf( square( edge ), 1e-30f ) );
}

// A group of eight hinges of which only the first is one: the others are dummies, which do not move.
static void open_fold( wisp_hinge_args* args, const wisp_kernels* kernels, const wisp_fabric* fabric, int hinge,
                       float rigidity )
{
    const int32_t* corner = fabric->hinges + 4 * (size_t)hinge;
    int32_t slot_x4[4][8];
    float rest[8] = { 0 }, compliance[8] = { 0 };
    for ( int i = 0; i < 32; ++i )
    {
        slot_x4[i / 8][i % 8] = 4 * ( i % 8 == 0 ? corner[i / 8] : fabric->vertex_count );
    }
    compliance[0] = compliance_of( fabric, corner, rigidity );
    args->slot_x4 = slot_x4[0];
    args->rest = rest;
    args->compliance = compliance;
    kernels->hinge_dihedral( args, 0, 8 );
}

static void open_group( wisp_hinge_args* args, const wisp_kernels* kernels, const wisp_fabric* fabric, int group,
                        uint8_t lanes, float rigidity )
{
    for ( int lane = 0; lane < 8; ++lane )
    {
        if ( ( lanes >> lane & 1 ) != 0 )
        {
            const int link = fabric->link_order.constraint[group * 8 + lane];
            open_fold( args, kernels, fabric, link - fabric->edge_count, rigidity );
        }
    }
}

// ---- passes ----

// Words of a byte for each group of eight links.
static int word_count( const wisp_fabric* fabric )
{
    return ( fabric->link_order.slot_count / 8 + 7 ) / 8;
}

bool passes_begin_folds( wisp_frame* frame, const wisp_span* span, wisp_link_args* args )
{
    if ( wisp_frame_has( frame, span->entity, WISP_LINK_FOLDS ) == false )
    {
        return true;
    }
    const int32_t* count = wisp_frame_column( frame, span->entity, WISP_LINK_FOLDS, 1 );
    int32_t* wait = wisp_frame_column( frame, span->entity, WISP_LINK_FOLDS, 2 );
    if ( *count == 0 && *wait > 0 )
    {
        *wait -= 1;
        return true;
    }
    *wait = PASSES_BETWEEN;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const size_t bytes = (size_t)word_count( fabric ) * sizeof( uint64_t );
    args->constraint = fabric->link_order.constraint;
    args->edge_count = fabric->edge_count;
    args->folded = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( args->folded == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "folds: out of memory for %zu bytes", bytes );
        return false;
    }
    memset( args->folded, 0, bytes );
    return true;
}

void passes_open_folds( wisp_frame* frame, const wisp_span* span, const uint64_t* folded )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const float rigidity = *(float*)wisp_frame_column( frame, span->entity, WISP_LINK_FOLDS, 0 );
    int32_t* count = wisp_frame_column( frame, span->entity, WISP_LINK_FOLDS, 1 );
    const float dt = wisp_frame_dt( frame );
    wisp_hinge_args args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                             .inverse_dt2 = 1.0f / ( dt * dt ) };
    *count = 0;
    for ( int word = 0; word < word_count( fabric ); ++word )
    {
        for ( int group = 8 * word; folded[word] != 0 && group < 8 * word + 8; ++group )
        {
            const uint8_t lanes = ( (const uint8_t*)folded )[group];
            open_group( &args, kernels, fabric, group, lanes, rigidity );
            *count += lanes != 0;
        }
    }
}
