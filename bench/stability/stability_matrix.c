// From axes to cells. The full product would be thousands of runs per solver. Engines break with one axis at its end,
// or with two at once. So each axis is swept alone from a base that every solver should hold, and all pairs of ends
// are run.
#include "stability.h"

#include <stdio.h>
#include <stdlib.h>

#define POINTS_MAX 6
#define CELLS_MAX 128

// A position on an axis: its effect on the axes, and its name.
typedef struct place
{
    const char* name;
    stability_axes axes;
    bool is_end; // paired with the ends of the other axes
    bool quick;
} place;

enum
{
    AXIS_START,
    AXIS_STEP,
    AXIS_MASS,
    AXIS_STIFFNESS,
    AXIS_SCALE,
    AXIS_COUNT,
};

// Only the axis's own number is read.
static const place places[AXIS_COUNT][POINTS_MAX] = {
    [AXIS_START] = { { "random", { .start = STABILITY_START_RANDOM }, true, true },
                     { "plane", { .start = STABILITY_START_PLANE }, true, false },
                     { "point", { .start = STABILITY_START_POINT }, true, true },
                     { "inside out", { .start = STABILITY_START_INSIDE_OUT }, true, true },
                     { "ten twists", { .start = STABILITY_START_TWISTS }, true, false } },
    [AXIS_STEP] = { { "dt 1/960", { .seconds = 1.0f / 960.0f }, false, false },
                    { "dt 1/240", { .seconds = 1.0f / 240.0f }, true, false },
                    { "dt 1/15", { .seconds = 1.0f / 15.0f }, false, false },
                    { "dt 1/5", { .seconds = 0.2f }, true, true } },
    [AXIS_MASS] = { { "mass 1e3", { .mass_ratio = 1e3f }, false, false },
                    { "mass 1e6", { .mass_ratio = 1e6f }, true, true } },
    [AXIS_STIFFNESS] = { { "k 1", { .stiffness = 1.0f }, true, false },
                         { "k 1e4", { .stiffness = 1e4f }, false, false },
                         { "k 1e8", { .stiffness = 1e8f }, true, false },
                         { "k 1e12", { .stiffness = 1e12f }, true, true } },
    [AXIS_SCALE] = { { "scale 1e-3", { .scale = 1e-3f }, true, true },
                     { "scale 0.1", { .scale = 0.1f }, false, false },
                     { "scale 10", { .scale = 10.0f }, false, false },
                     { "scale 1e3", { .scale = 1e3f }, true, false } },
};

static void put( stability_axes* axes, int axis, const place* p )
{
    switch ( axis )
    {
        case AXIS_START:
            axes->start = p->axes.start;
            break;
        case AXIS_STEP:
            axes->seconds = p->axes.seconds;
            break;
        case AXIS_MASS:
            axes->mass_ratio = p->axes.mass_ratio;
            break;
        case AXIS_STIFFNESS:
            axes->stiffness = p->axes.stiffness;
            break;
        default:
            axes->scale = p->axes.scale;
            break;
    }
}

typedef struct maker
{
    const stability_subject* subject;
    bool quick;
    stability_cell* cells;
    int count;
} maker;

static bool has_axis( const maker* m, int axis )
{
    return !( axis == AXIS_STIFFNESS && m->subject->has_stiffness == false ) &&
           !( axis == AXIS_MASS && m->subject->has_mass_ratio == false );
}

static stability_cell* add( maker* m, const char* first, const char* second )
{
    stability_cell* cell = m->cells + m->count++;
    *cell = ( stability_cell ){
        .subject = m->subject,
        .axes = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f },
    };
    snprintf( cell->name, sizeof( cell->name ), "%s: %s%s%s", m->subject->name, first, second[0] ? ", " : "",
              second );
    return cell;
}

static bool must_refuse( const stability_cell* cell )
{
    const float most = cell->subject->max_stiffness;
    return most > 0.0f && cell->axes.stiffness > most;
}

static void add_pairs( maker* m, int axis, int other )
{
    for ( int i = 0; i < POINTS_MAX * POINTS_MAX; ++i )
    {
        const place *p = &places[axis][i / POINTS_MAX], *q = &places[other][i % POINTS_MAX];
        if ( p->is_end && q->is_end )
        {
            stability_cell* cell = add( m, p->name, q->name );
            put( &cell->axes, axis, p );
            put( &cell->axes, other, q );
            cell->is_refused = must_refuse( cell );
        }
    }
}

static void add_axis( maker* m, int axis )
{
    for ( int i = 0; i < POINTS_MAX; ++i )
    {
        const place* p = &places[axis][i];
        if ( p->name != NULL && ( p->quick || m->quick == false ) )
        {
            stability_cell* cell = add( m, p->name, "" );
            put( &cell->axes, axis, p );
            cell->is_refused = must_refuse( cell );
            cell->two_workers = p->axes.start == STABILITY_START_RANDOM;
        }
    }
}

int stability_matrix( const stability_subject* subject, bool quick, stability_cell** cells )
{
    *cells = calloc( CELLS_MAX, sizeof( **cells ) );
    if ( *cells == NULL )
    {
        return -1;
    }
    maker m = { .subject = subject, .quick = quick, .cells = *cells };
    add( &m, "base", "" );
    // cells with one axis first: pairs are compared with them
    for ( int axis = 0; axis < AXIS_COUNT; ++axis )
    {
        if ( has_axis( &m, axis ) )
        {
            add_axis( &m, axis );
        }
    }
    for ( int i = 0; i < AXIS_COUNT * AXIS_COUNT && subject->has_pairs && quick == false; ++i )
    {
        const int axis = i / AXIS_COUNT, other = i % AXIS_COUNT;
        if ( axis < other && has_axis( &m, axis ) && has_axis( &m, other ) )
        {
            add_pairs( &m, axis, other );
        }
    }
    WISP_ASSERT( m.count <= CELLS_MAX );
    return m.count;
}

int stability_twin( const stability_cell* cells, int cell )
{
    const stability_axes* mine = &cells[cell].axes;
    for ( int i = 0; i < cell && mine->start != STABILITY_START_REST; ++i )
    {
        const stability_axes* other = &cells[i].axes;
        if ( other->start == STABILITY_START_REST && other->seconds == mine->seconds &&
             other->mass_ratio == mine->mass_ratio && other->stiffness == mine->stiffness &&
             other->scale == mine->scale )
        {
            return i;
        }
    }
    return -1;
}
