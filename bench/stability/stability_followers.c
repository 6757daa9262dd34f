// Followers without motion of their own: ghosts of strands, frozen hair on a groom, boundary particles on a cloth.
// Their targets have bad starts; followers must stay finite, and be at rest when the target is.
#include "stability_cloth.h"
#include "stability_strands.h"

#include "boundary/boundary.h"
#include "frozen_hair/frozen_hair.h"
#include "guide_hair/guide_hair.h"

#include <math.h>
#include <stdlib.h>

// ---- ghosts, and frozen hair: strands on top of strands ----

#define GHOSTS 16
#define GHOST_POINTS ( GHOSTS * STABILITY_VERTICES )

typedef struct follower
{
    stability_strands* guides;
    wisp_entity entity;
    wisp_vec3 seen[GHOST_POINTS];
} follower;

static bool all_finite( const wisp_vec3* points, int count )
{
    bool finite = true;
    for ( int i = 0; i < count; ++i )
    {
        finite = finite && isfinite( points[i].x ) && isfinite( points[i].y ) && isfinite( points[i].z );
    }
    return finite;
}

static wisp_status step( void* context, int frame, wisp_error* error )
{
    return stability_strands_step( ( (follower*)context )->guides, frame, error );
}

// The sample of the guides, and of the ghosts whether they are finite and their speed.
static wisp_status observe( void* context, int frame, stability_observation* out, wisp_error* error )
{
    follower* f = context;
    wisp_view view = { 0 };
    wisp_status status = stability_strands_observe( f->guides, frame, out, error );
    if ( status != WISP_OK || frame == 0 )
    {
        return status;
    }
    status = wisp_world_view( f->guides->world, f->entity, WISP_STRAND_POINTS, &view );
    if ( status != WISP_OK )
    {
        return bench_world_fail( f->guides->world, status, error );
    }
    const wisp_vec3* points = view.data;
    out->is_finite = out->is_finite && all_finite( points, GHOST_POINTS );
    out->is_halted = out->is_halted || wisp_is_halted( f->guides->world, f->entity );
    const double speed = stability_farthest( points, f->seen, GHOST_POINTS ) / f->guides->seconds;
    out->speed = frame > 1 ? fmax( out->speed, speed ) : out->speed;
    for ( int i = 0; i < GHOST_POINTS; ++i )
    {
        f->seen[i] = points[i];
    }
    return WISP_OK;
}

static uint64_t hash( void* context )
{
    follower* f = context;
    uint64_t value = 0;
    return wisp_world_hash_column( f->guides->world, f->entity, WISP_STRAND_POINTS, &value ) == WISP_OK ? value : 0;
}

static void close_follower( void* context )
{
    follower* f = context;
    if ( f->guides != NULL )
    {
        stability_strands_close( f->guides );
    }
    free( f );
}

// Two ghosts next to every guide; all of them in one point where a groom is collapsed.
static wisp_status add_ghosts( follower* f, bool is_point )
{
    int32_t offsets[GHOSTS + 1];
    wisp_vec3 points[GHOST_POINTS];
    for ( int i = 0; i <= GHOSTS; ++i )
    {
        offsets[i] = i * STABILITY_VERTICES;
    }
    for ( int i = 0; i < GHOST_POINTS; ++i )
    {
        const int ghost = i / STABILITY_VERTICES;
        const wisp_vec3 p = f->guides->rest[ghost / 2 * STABILITY_VERTICES + i % STABILITY_VERTICES];
        const float aside = ghost % 2 == 0 ? 0.002f : -0.003f;
        points[i] = is_point ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : ( wisp_vec3 ){ p.x + aside, p.y, p.z + aside };
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = GHOSTS;
    const wisp_status status = wisp_add_strands( f->guides->world, &def, &f->entity );
    return status == WISP_OK ? wisp_request( f->guides->world, f->entity, WISP_STRAND_POINTS ) : status;
}

static wisp_status dress_ghosts( follower* f )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.targets = f->guides->entity;
    return wisp_set_ghosts( f->guides->world, f->entity, &def );
}

// @param stiffness of both kinds, no unit
static wisp_status freeze( follower* f, float stiffness )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.stretch_stiffness = stiffness;
    def.bend_stiffness = stiffness;
    return wisp_set_frozen_hair( f->guides->world, f->entity, &def );
}

typedef struct following
{
    stability_start start;
    bool is_frozen, is_point;
    float stiffness;
} following;

static const following kinds[] = {
    { STABILITY_START_REST, false, false, 0.0f },  { STABILITY_START_RANDOM, false, false, 0.0f },
    { STABILITY_START_POINT, false, false, 0.0f }, { STABILITY_START_TWISTS, false, false, 0.0f },
    { STABILITY_START_REST, false, true, 0.0f },   { STABILITY_START_REST, true, false, 1.0f },
    { STABILITY_START_REST, true, false, 1e12f },  { STABILITY_START_REST, true, true, 7.0f },
};

static wisp_status enter( const following* kind, int workers, follower* f, stability_trial* trial, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_frozen_hair_module, &wisp_guide_hair_module,
                                                  &wisp_strands_module };
    const stability_axes axes = { kind->start, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };
    f->guides = calloc( 1, sizeof( *f->guides ) );
    if ( f->guides == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    f->guides->def = stability_strand_def( STABILITY_ROD, &axes );
    wisp_status status = stability_strands_enter( f->guides, modules, WISP_COUNT( modules ), &axes, workers, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_ghosts( f, kind->is_point );
    if ( status == WISP_OK )
    {
        status = kind->is_frozen ? freeze( f, kind->stiffness ) : dress_ghosts( f );
    }
    if ( status != WISP_OK )
    {
        return bench_world_fail( f->guides->world, status, error );
    }
    *trial = stability_strands_trial( f->guides, &axes );
    trial->context = f;
    trial->step = step;
    trial->observe = observe;
    trial->hash = hash;
    trial->close = close_follower;
    return WISP_OK;
}

static wisp_status follow( int kind, int workers, stability_outcome* out, wisp_error* error )
{
    follower* f = calloc( 1, sizeof( *f ) );
    if ( f == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    stability_trial trial;
    const wisp_status status = enter( kinds + kind, workers, f, &trial, error );
    if ( status != WISP_OK )
    {
        close_follower( f );
        return status;
    }
    return stability_run( &trial, out, error );
}

// ---- boundary particles ----

static double count_bad_particles( stability_surface* s )
{
    wisp_boundary_view view;
    int bad = 1;
    if ( wisp_read_boundary( s->implementation.world, s->implementation.entity, &view ) == WISP_OK )
    {
        bad = 0;
        for ( int i = 0; i < view.samples->count * 4; ++i )
        {
            bad += i % 4 == 3 || isfinite( view.samples->xyzw[i] ) ? 0 : 1;
        }
    }
    return bad;
}

static wisp_status sample( int start, int workers, stability_outcome* out, wisp_error* error )
{
    const stability_axes axes = { (stability_start)start, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };
    stability_cloth_plan plan = stability_default_cloth_plan( STABILITY_XPBD_DIHEDRAL );
    plan.has_boundary = true;
    stability_surface* s;
    wisp_status status = stability_cloth_enter( &plan, &axes, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_boundary_def def = wisp_default_boundary_def();
    status = wisp_set_boundary( s->implementation.world, s->implementation.entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( s->implementation.world, status, error );
        stability_surface_close( s );
        return status;
    }
    stability_trial trial = stability_surface_trial( s, &axes );
    s->breach = count_bad_particles;
    return stability_run( &trial, out, error );
}

static const stability_named cells[] = {
    { "ghosts: guides at rest", false, false, 0, follow },
    { "ghosts: guides random", true, false, 1, follow },
    { "ghosts: guides in a point", false, false, 2, follow },
    { "ghosts: guides in ten twists", false, false, 3, follow },
    { "ghosts: all in a point", false, false, 4, follow },
    { "frozen hair: k 1", false, false, 5, follow },
    { "frozen hair: k 1e12", true, false, 6, follow },
    { "frozen hair: all in a point", false, false, 7, follow },
    { "boundary: cloth random", true, false, STABILITY_START_RANDOM, sample },
    { "boundary: cloth in a point", false, false, STABILITY_START_POINT, sample },
};

const stability_named* stability_followers( int* count )
{
    *count = WISP_COUNT( cells );
    return cells;
}
