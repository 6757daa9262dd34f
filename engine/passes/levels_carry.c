// The motion of the coarsest sheet: substeps of XPBD, integrated by BDF2.
//
// With X the position, V the velocity, d the displacement and e = d / h the mean velocity of a substep of length h, BDF2 is
//
//     X' = X + d_1 / 3 + 2/3 h ( V + ( V - V_1 ) / 3 + 2/3 h a ),  projected with 2/3 h,   V' = ( 3 d - d_1 ) / ( 2 h ),
//
// where d_1 and V_1 are those of the substep before. The history is kept as two accelerations, c = ( V - V_1 ) / h and
// l = ( V - e ) / h, and V_1 = V - h c, d_1 = h V - h^2 l. So an impulse that the surface got from contact, or another length of a
// substep, changes V alone and is not taken for an acceleration.
#include "levels.h"

// A substep of the sheet.
typedef struct sheet_step
{
    float dt, solve_dt; // s, its length, and the one with which links are projected
    bool second_order;
    float progress; // fraction of the way of pinned rows that is left
} sheet_step;

static bool is_pinned( const levels_carrier* c, int row )
{
    return c->sheet.links.position[4 * row + 3] <= 0.0f;
}

static void predict( const levels_carrier* c, const sheet_step* s )
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

static void finish( levels_carrier* c, const sheet_step* s )
{
    const float inverse = 1.0f / s->dt;
    for ( int row = 0; row < c->sheet.level->vertex_count; ++row )
    {
        const bool follows = s->second_order && is_pinned( c, row ) == false;
        for ( int k = 0, i = 4 * row; k < 3; ++k, ++i )
        {
            const float v = c->velocity[i], mean = inverse * ( c->sheet.links.position[i] - c->start[i] );
            const float last = follows ? 1.5f * mean - 0.5f * ( v - s->dt * c->lag[i] ) : mean;
            c->change[i] = inverse * ( last - v );
            c->lag[i] = inverse * ( last - mean );
            c->velocity[i] = last;
        }
    }
}

void levels_move_carrier( levels_carrier* c )
{
    const int count = *c->columns.substeps;
    for ( int j = 0; j < count; ++j )
    {
        const float dt = c->dt / (float)count;
        const bool second_order = *c->columns.state == LEVELS_MOVING;
        const sheet_step s = { dt, second_order ? dt * 2.0f / 3.0f : dt, second_order, 1.0f / (float)( count - j ) };
        predict( c, &s );
        if ( j == 0 )
        {
            levels_find_band( &c->sheet );
        }
        levels_project( &c->sheet, s.solve_dt, *c->columns.passes );
        finish( c, &s );
        *c->columns.state = LEVELS_MOVING;
    }
}
