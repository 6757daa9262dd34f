// Sharp folds: hinges whose opposite vertices are nearer than half their distance at rest. Links between these vertices and
// quadratic bending do not know on which side of each other the triangles lie, and smooth bending is slow to turn them. So
// such hinges are projected by the angle between their triangles, which has a direction even in a flat fold.
#include "passes.h"

#include "wisp/module/components.h"
#include "wisp/module/vec.h"
#include <string.h>

// The energy of an angle t is 1/2 B e^2 t^2 / A, with rigidity B, edge e and the area A of both triangles.
static float compliance_of( const wisp_fabric* fabric, const int32_t* corner, float rigidity )
{
    const wisp_vec3 *rest = fabric->rest, edge = wisp_v3_sub( rest[corner[1]], rest[corner[0]] );
    const float both =
        0.5f * wisp_v3_length( wisp_v3_cross( edge, wisp_v3_sub( rest[corner[2]], rest[corner[0]] ) ) ) +
        0.5f * wisp_v3_length( wisp_v3_cross( edge, wisp_v3_sub( rest[corner[3]], rest[corner[0]] ) ) );
    return both / ( rigidity * fmaxf( wisp_v3_dot( edge, edge ), 1e-30f ) );
}

// Find the corners of the hinge of a slot of hinges, or of a bend link.
static void find_corners( const wisp_fabric* fabric, int slot, bool is_link, int32_t corner[4] )
{
    if ( is_link )
    {
        const int hinge = fabric->link_order.constraint[slot] - fabric->edge_count;
        memcpy( corner, fabric->hinges + 4 * (size_t)hinge, 4 * sizeof( int32_t ) );
    }
    else
    {
        wisp_fabric_hinge_corners( fabric, slot, corner );
    }
}

// Project the folds among the constraints of a group. The other lanes are dummies, which do not move.
static void open_lanes( wisp_hinge_args* args, const wisp_kernels* kernels, const wisp_fabric* fabric, int group,
                        bool are_links, unsigned lanes, float rigidity )
{
    int32_t slot_x4[4][8];
    float rest[8] = { 0 }, compliance[8] = { 0 };
    for ( int lane = 0; lane < 8; ++lane )
    {
        const bool is_fold = ( lanes >> lane & 1 ) != 0;
        int32_t corner[4] = { fabric->vertex_count, fabric->vertex_count, fabric->vertex_count,
                              fabric->vertex_count };
        if ( is_fold )
        {
            find_corners( fabric, 8 * group + lane, are_links, corner );
        }
        for ( int k = 0; k < 4; ++k )
        {
            slot_x4[k][lane] = 4 * corner[k];
        }
        compliance[lane] = is_fold ? compliance_of( fabric, corner, rigidity ) : 0.0f;
    }
    args->slot_x4 = slot_x4[0];
    args->rest = rest;
    args->compliance = compliance;
    kernels->hinge_dihedral( args, 0, 8 );
}

// Hinges of a group share no vertex, but bend links share the ends of their hinges.
static void open_group( wisp_hinge_args* args, const wisp_kernels* kernels, const wisp_fabric* fabric, int group,
                        bool are_links, unsigned lanes, float rigidity )
{
    for ( unsigned left = lanes; left != 0; )
    {
        const unsigned at_once = are_links ? left & ( ~left + 1u ) : left;
        open_lanes( args, kernels, fabric, group, are_links, at_once, rigidity );
        left &= ~at_once;
    }
}

// ---- searches ----

// A constraint order whose folds are looked for, and the component with their rigidity and count.
typedef struct fold_order
{
    const wisp_schedule* schedule;
    bool are_links;
    wisp_component component;
} fold_order;

// Words of a byte for each group of eight constraints.
static int word_count( const fold_order* order )
{
    return ( order->schedule->slot_count / 8 + 7 ) / 8;
}

// Get bytes for a search, if one is due: while there are folds, and from time to time. @return false if out of memory
static bool begin_search( wisp_frame* frame, const wisp_span* span, const fold_order* order, uint64_t** out )
{
    *out = NULL;
    const int32_t* count = wisp_frame_column( frame, span->entity, order->component, 1 );
    int32_t* wait = wisp_frame_column( frame, span->entity, order->component, 2 );
    if ( *count == 0 && *wait > 0 )
    {
        *wait -= 1;
        return true;
    }
    *wait = PASSES_BETWEEN_FOLDS;
    const size_t bytes = (size_t)word_count( order ) * sizeof( uint64_t );
    *out = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( *out == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "folds: out of memory for %zu bytes", bytes );
        return false;
    }
    memset( *out, 0, bytes );
    return true;
}

// Project what was found, in the order of the schedule, so that bits do not depend on workers.
static void open_found( wisp_frame* frame, const wisp_span* span, const fold_order* order, const uint64_t* folded )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const float rigidity = *(float*)wisp_frame_column( frame, span->entity, order->component, 0 );
    int32_t* count = wisp_frame_column( frame, span->entity, order->component, 1 );
    const float dt = wisp_frame_dt( frame, span->entity );
    wisp_hinge_args args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                             .inverse_dt2 = 1.0f / ( dt * dt ) };
    *count = 0;
    for ( int word = 0; word < word_count( order ); ++word )
    {
        if ( folded[word] != 0 && order->are_links && wisp_fabric_need( fabric, WISP_FABRIC_HINGES ) != WISP_OK )
        {
            wisp_frame_fail( frame, WISP_NO_MEMORY, "folds: out of memory for %d hinges", fabric->hinge_count );
            return;
        }
        for ( int group = 8 * word; folded[word] != 0 && group < 8 * word + 8; ++group )
        {
            const uint8_t lanes = ( (const uint8_t*)folded )[group];
            open_group( &args, kernels, fabric, group, order->are_links, lanes, rigidity );
            *count += lanes != 0;
        }
    }
}

// ---- bend links ----

static fold_order order_of_links( const wisp_fabric* fabric )
{
    return ( fold_order ){ &fabric->link_order, true, WISP_LINK_FOLDS };
}

bool passes_begin_folds( wisp_frame* frame, const wisp_span* span, wisp_link_args* args )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const fold_order order = order_of_links( fabric );
    uint64_t* folded = NULL;
    const bool has_memory = wisp_frame_has( frame, span->entity, WISP_LINK_FOLDS ) == false ||
                            begin_search( frame, span, &order, &folded );
    args->folded = (uint8_t*)folded;
    return has_memory;
}

void passes_open_folds( wisp_frame* frame, const wisp_span* span, const uint64_t* folded )
{
    const fold_order order = order_of_links( wisp_frame_fabric( frame, span->entity ) );
    open_found( frame, span, &order, folded );
}

// ---- hinges ----

WISP_KERNEL_LOOP( fold_search, search_groups, hinge_find_folds, wisp_fold_args, 8 )

void passes_open_hinges( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const fold_order order = { &fabric->hinge_order, false, WISP_HINGE_FOLDS };
    uint64_t* folded;
    if ( begin_search( frame, span, &order, &folded ) && folded != NULL )
    {
        fold_search search = { .kernels = wisp_frame_kernels( frame ) };
        search.args = ( wisp_fold_args ){ wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                                          fabric->hinge_slot_x4, fabric->hinge_span2, (uint8_t*)folded };
        wisp_parallel_for( wisp_frame_parallel( frame, span ), fabric->hinge_order.slot_count / 8, 512, search_groups,
                           &search );
        open_found( frame, span, &order, folded );
    }
}
