// The motion of the coarsest sheet: substeps of XPBD, integrated by BDF2.
//
// With X the position, V the velocity, d the displacement and e = d / h the mean velocity of a substep of length h, BDF2 is
//
//     X' = X + d_1 / 3 + 2/3 h ( V + ( V - V_1 ) / 3 + 2/3 h a ),  projected with 2/3 h,   V' = ( 3 d - d_1 ) / ( 2 h ),
//
// where d_1 and V_1 are those of the substep before. The history is kept as two accelerations, c = ( V - V_1 ) / h and
// l = ( V - e ) / h, and V_1 = V - h c, d_1 = h V - h^2 l. So an impulse that the surface got from contact, or another length of a
// substep, changes V alone and is not taken for an acceleration.
//
// Where such an acceleration would move a row by more than a fraction of a link in a substep of the surface, substeps are too long
// to extrapolate from. It is shortened then, and so is what second order adds to the velocity: by the square of the excess, so that
// the sheet becomes Euler's as substeps grow.
#include "levels.h"

// Fraction of the mean link by which a remembered acceleration may move a row.
#define MAX_REMEMBERED 0.1f
// Times its rest length at which a link is torn: its ends were moved apart, and what the sheet would do is of no use to the surface.
#define TORN 100.0f

// A substep of the sheet.
typedef struct sheet_step
{
    float dt, solve_dt; // s, its length, and the one with which links are projected
    bool second_order;
    float progress; // fraction of the way of pinned rows that is left
    float reach;    // m, limit of what is remembered
} sheet_step;

static bool is_pinned( const levels_carrier* c, int row )
{
    return c->sheet.links.position[4 * row + 3] <= 0.0f;
}

static void predict_level( const levels_carrier* c, const sheet_step* s )
{
    const float h = s->dt, he = s->solve_dt;
    for ( int row = 0; row < c->sheet.level->vertex_count; ++row )
    {
        const bool pinned = is_pinned( c, row );
        for ( int k = 0, i = 4 * row; k < 3; ++k, ++i )
        {
            const float x = c->sheet.links.position[i], v = c->velocity[i];
            c->start[i] = x;
            if ( pinned )
            {
                c->sheet.links.position[i] = x + s->progress * ( c->target[i] - x );
                continue;
            }
            const float moved = s->second_order ? ( h * v - h * h * c->lag[i] ) / 3.0f : 0.0f;
            const float faster = s->second_order ? h * c->change[i] / 3.0f : 0.0f;
            c->sheet.links.position[i] = x + moved + he * ( v + faster + he * c->acceleration[i] );
        }
    }
}

// Shortens a vector that is longer than a limit, the more, the longer it is.
static void limit( float v[3], float most )
{
    const float d2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if ( d2 > most * most )
    {
        const float scale = most * most / d2;
        for ( int k = 0; k < 3; ++k )
        {
            v[k] *= scale;
        }
    }
}

static void finish( levels_carrier* c, const sheet_step* s )
{
    const float inverse = 1.0f / s->dt, fastest = s->reach / ( c->dt * c->dt );
    for ( int row = 0; row < c->sheet.level->vertex_count; ++row )
    {
        const bool follows = s->second_order && is_pinned( c, row ) == false;
        float added[3] = { 0.0f, 0.0f, 0.0f }, *change = c->change + 4 * row, *lag = c->lag + 4 * row;
        for ( int k = 0, i = 4 * row; k < 3 && follows; ++k, ++i )
        {
            const float mean = inverse * ( c->sheet.links.position[i] - c->start[i] );
            added[k] = 0.5f * ( mean - ( c->velocity[i] - s->dt * lag[k] ) );
        }
        limit( added, 0.5f * fastest * c->dt );
        for ( int k = 0, i = 4 * row; k < 3; ++k, ++i )
        {
            const float mean = inverse * ( c->sheet.links.position[i] - c->start[i] ), last = mean + added[k];
            change[k] = inverse * ( last - c->velocity[i] );
            lag[k] = inverse * added[k];
            c->velocity[i] = last;
        }
        limit( change, fastest );
        limit( lag, fastest );
    }
}

// Finds the mean rest length of the links. @return false if one is torn
static bool measure_links( const levels_carrier* c, float* mean_rest )
{
    const wisp_fabric_level* level = c->sheet.level;
    const float* position = c->sheet.links.position;
    double sum = 0.0;
    for ( int link = 0; link < level->schedule.slot_count; ++link )
    {
        const float *a = position + level->a_x4[link], *b = position + level->b_x4[link];
        const float d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] }, most = TORN * level->rest[link];
        if ( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > most * most && level->schedule.constraint[link] >= 0 )
        {
            return false;
        }
        sum += (double)level->rest[link];
    }
    *mean_rest = (float)( sum / (double)level->link_count );
    return true;
}

bool levels_move_carrier( levels_carrier* c )
{
    const int count = *c->columns.substeps;
    float mean_rest;
    if ( measure_links( c, &mean_rest ) == false )
    {
        return false;
    }
    for ( int j = 0; j < count; ++j )
    {
        const float dt = c->dt / (float)count;
        const bool second_order = *c->columns.state == LEVELS_MOVING;
        const sheet_step s = {
            .dt = dt,
            .solve_dt = second_order ? dt * 2.0f / 3.0f : dt,
            .second_order = second_order,
            .progress = 1.0f / (float)( count - j ),
            .reach = MAX_REMEMBERED * mean_rest,
        };
        predict_level( c, &s );
        if ( j == 0 )
        {
            levels_find_band( &c->sheet );
        }
        c->sheet.pin_fraction = (float)( j + 1 ) / (float)count;
        levels_project( &c->sheet, s.solve_dt, *c->columns.passes );
        finish( c, &s );
        *c->columns.state = LEVELS_MOVING;
    }
    return true;
}
