// Two balloons pressed together between plates, kept apart by boundary particles or by their triangles: the cost of
// the particles' spacing, and the overlap that they leave.
#include "contact_overlap.h"
#include "scene_tools.h"

#include <math.h>
#include <stdlib.h>

#define PRESS_STEPS 80 // the plates have come to rest after PAIR_CLOSING
#define PRESS_OBSERVATION 10
#define FEW_LEVEL 1 // of the icosphere
#define MANY_LEVEL 2
#define FULL_SECONDS 15.0

#define WAYS_MAX 16

typedef struct presses
{
    contact_scene scene;
    contact_way ways[WAYS_MAX];
} presses;

// ---- measures ----

enum
{
    OVERLAP_LAST,
    MISSED,
    INTERSECTIONS,
    CONTACTS,
    MEASURES,
};

// The maximum over all samples, except contacts and overlap, which are those of the last one: a pair that is pressed
// hard may have slipped aside by then.
static wisp_status observe( const presses* all, contact_world* world, accuracy_run* out, wisp_error* error )
{
    contact_overlap overlap = { 0 };
    wisp_contact_stats stats = { 0 };
    wisp_status status = contact_find_overlap( world, &overlap, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_contact_stats( world->world, &stats );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( world->world, status, error );
    }
    const double vertices = 2.0 * all->scene.mesh.vertex_count;
    out->measures[OVERLAP_LAST] = 1e3 * fmax( overlap.overlap, 0.0 );
    out->error = fmax( out->error, out->measures[OVERLAP_LAST] ); // NaN before the first sample
    out->measures[MISSED] = fmax( out->measures[MISSED], 100.0 * overlap.missed / vertices );
    out->measures[INTERSECTIONS] = fmax( out->measures[INTERSECTIONS], stats.intersections );
    out->measures[CONTACTS] = stats.contacts;
    return status;
}

// ---- a run ----

static wisp_status run_press( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const presses* all = context;
    const contact_setting chosen = { .way = all->ways[setting], .workers = workers, .requests_stats = is_observed };
    contact_world world = { 0 };
    wisp_status status = contact_enter_pair( &all->scene, &chosen, &world, error );
    for ( int s = 1; s <= PRESS_STEPS && status == WISP_OK; ++s )
    {
        const bool is_due = is_observed && s % PRESS_OBSERVATION == 0;
        status = accuracy_time_step( contact_step, &world, out, error );
        status = status == WISP_OK && is_due ? observe( all, &world, out, error ) : status;
    }
    status = status == WISP_OK ? contact_hash( &world, &out->hash, error ) : status;
    out->halted_at = world.halted_at;
    contact_leave( &world );
    return status;
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, contact_way way )
{
    presses* all = scene->context;
    all->ways[scene->setting_count] = way;
    return accuracy_put_setting( scene, "%s", way.name );
}

// How close surfaces come between particles depends on the relative position of the particles, so no order is
// expected.
static void put_spacings( accuracy_scene* scene )
{
    static const contact_way ways[] = {
        { .name = "particles, 8 thicknesses apart", .spacing = 8.0f },
        { .name = "particles, 4 thicknesses apart", .spacing = 4.0f },
        { .name = "particles, 2 thicknesses apart", .spacing = 2.0f },
        { .name = "particles, a thickness apart", .spacing = 1.0f },
        { .name = "particles, 0.7 thicknesses apart", .spacing = 0.7f },
    };
    const presses* all = scene->context;
    for ( int i = 0; i < WISP_COUNT( ways ); ++i )
    {
        contact_way way = ways[i];
        way.primitives = WISP_CONTACT_PARTICLES;
        way.margin = 2.0f;
        accuracy_join_series( put_way( scene, way ), "particles", "spacing, m",
                              (double)( way.spacing * all->scene.thickness ), NAN );
    }
}

static void destroy_presses( void* context )
{
    presses* all = context;
    contact_scene_free( &all->scene );
    free( all );
}

wisp_status accuracy_boundary_contact( const bench_options* options, double seconds, accuracy_scene* out,
                                       wisp_error* error )
{
    (void)options;
    presses* all = calloc( 1, sizeof( presses ) );
    *out = ( accuracy_scene ){
        .reference = "vertices stay at least the thickness away from the triangles of the other surface; measured by "
                     "signed distances, independent of contact",
        .error_name = "overlap at most",
        .error_unit = "mm",
        .measure_names = { "at the end mm", "missed vertices %", "intersections at most", "contacts" },
        .measure_count = MEASURES,
        .context = all,
        .run = run_press,
        .destroy = destroy_presses,
    };
    if ( !all )
    {
        return accuracy_abandon( out, wisp_fail( error, WISP_NO_MEMORY, "no memory for balloons that are pressed" ) );
    }
    wisp_status status = contact_make_balloon( seconds < FULL_SECONDS ? FEW_LEVEL : MANY_LEVEL, &all->scene, error );
    status = status == WISP_OK ? accuracy_reserve_settings( out, WAYS_MAX, error ) : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    const contact_way none = { .name = "nothing", .is_off = true, .margin = 2.0f };
    const contact_way unguarded = { .name = "exact, no guard", .margin = 2.0f, .no_displacement_limit = true };
    put_way( out, none );
    put_spacings( out );
    put_way( out, unguarded );
    const contact_way exact = { .name = "exact", .margin = 2.0f };
    put_way( out, exact );
    return WISP_OK;
}
