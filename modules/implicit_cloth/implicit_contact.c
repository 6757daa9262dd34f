// Contact inside the solver (Noh and Jung, section 4; docs/methods.md lists the rules): which vertices are held, land, stick
// or slide, and which motion a row keeps.
#include "implicit_internal.h"

#include "wisp/module/vec.h"

#include <string.h>

// An active contact of this substep.
typedef struct touch
{
    int place; // in particle.contacts
    wisp_vec3 normal, motion;
    float gap, margin, static_friction, kinetic_friction, recovery;
    bool held, is_new; // not held: it lands
    float pressed;     // kg m/s, of the last solve
} touch;

// ---- filters ----

static void write_filter( const implicit_system* s, int row, const float filter[6] )
{
    float* to = s->filter_floats + (size_t)( row / WISP_SLICE ) * 6 * WISP_SLICE + row % WISP_SLICE;
    for ( int i = 0; i < 6; ++i )
    {
        to[i * WISP_SLICE] = filter[i];
    }
}

static wisp_vec3 read_lanes( const float ( *vectors )[3][WISP_SLICE], int row )
{
    const float( *v )[WISP_SLICE] = vectors[row / WISP_SLICE];
    const int lane = row % WISP_SLICE;
    return ( wisp_vec3 ){ v[0][lane], v[1][lane], v[2][lane] };
}

// S v of a row.
static wisp_vec3 filtered( const implicit_system* s, int row, wisp_vec3 v )
{
    const float* f = s->filter_floats + (size_t)( row / WISP_SLICE ) * 6 * WISP_SLICE + row % WISP_SLICE;
    const float xx = f[0], xy = f[WISP_SLICE], xz = f[2 * WISP_SLICE], yy = f[3 * WISP_SLICE], yz = f[4 * WISP_SLICE],
                zz = f[5 * WISP_SLICE];
    return ( wisp_vec3 ){ xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                          xz * v.x + yz * v.y + zz * v.z };
}

// Give all rows of a slice the identity filter when the first of them is held.
static void open_slice( const implicit_system* s, int slice )
{
    static const float IDENTITY[6] = { 1.0f, 0.0f, 0.0f, 1.0f, 0.0f, 1.0f };
    if ( s->filtered[slice] == 0 )
    {
        s->filtered[slice] = 1;
        for ( int lane = 0; lane < WISP_SLICE; ++lane )
        {
            write_filter( s, slice * WISP_SLICE + lane, IDENTITY );
        }
    }
}

// Prescribe `goal` for the part of the velocity that the filter constrains.
static void hold_row( const implicit_system* s, int row, const float filter[6], wisp_vec3 goal )
{
    open_slice( s, row / WISP_SLICE );
    write_filter( s, row, filter );
    float* to = s->goal + (size_t)row * 4;
    to[0] = goal.x;
    to[1] = goal.y;
    to[2] = goal.z;
    to[3] = 1.0f;
}

static const float NOTHING[6] = { 0.0f };

// ---- pins ----

static void hold_pin( const implicit_system* s, const implicit_contact_input* f, int row, int slot )
{
    const wisp_vec3 x = wisp_v3_load( f->position + (size_t)slot * 4 );
    wisp_vec3 there = x;
    if ( f->target != NULL && f->target[(size_t)slot * 4 + 3] != 0.0f )
    {
        const wisp_vec3 target = wisp_v3_load( f->target + (size_t)slot * 4 );
        there =
            f->target_fraction >= 1.0f ? target : wisp_v3_mul_add( x, f->target_fraction, wisp_v3_sub( target, x ) );
    }
    const wisp_vec3 displacement = wisp_v3_sub( there, wisp_v3_load( s->place + (size_t)row * 4 ) );
    const float rate = 1.0f / s->spring.dt;
    hold_row( s, row, NOTHING, ( wisp_vec3 ){ rate * displacement.x, rate * displacement.y, rate * displacement.z } );
    f->contact[slot] = ( implicit_contact ){ .slides = 0 };
}

// ---- held contacts ----

static touch read_touch( const implicit_contact_input* f, int slot, int place )
{
    const size_t at = (size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)place;
    const float *plane = f->plane + 4 * at, *motion = f->motion + 4 * at, *friction = f->friction + 3 * at;
    return ( touch ){
        .place = place,
        .normal = wisp_v3_load( plane ),
        .motion = wisp_v3_load( motion ),
        .gap = plane[3],
        .margin = motion[3],
        .static_friction = friction[0],
        .kinetic_friction = friction[1],
        .recovery = friction[2],
    };
}

// Whether this contact was held in the last substep, and its impulse then.
static bool was_held( const implicit_contact* before, int32_t body, float* pressed )
{
    for ( int i = 0; i < WISP_MAX_PARTICLE_CONTACTS; ++i )
    {
        if ( before->body[i] == body )
        {
            *pressed = before->pressed[i];
            return true;
        }
    }
    return false;
}

// Apply rules 1 to 3. @return whether the contact is active
static bool judge( const implicit_system* s, const implicit_contact_input* f, int row, int slot, touch* t,
                   implicit_counts* counts )
{
    const float mass = s->place[(size_t)row * 4 + 3];
    const wisp_vec3 v = wisp_v3_load( f->velocity + (size_t)slot * 4 );
    const float leaving = wisp_v3_dot( wisp_v3_sub( v, t->motion ), t->normal );
    const bool known = was_held( f->contact + slot,
                                 f->body[(size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)t->place], &t->pressed );
    // a vertex that moves out of a body must be stopped before it is released
    if ( known && t->pressed < -( f->hysteresis + fmaxf( 0.0f, leaving ) ) * mass )
    {
        counts->released += 1;
        return false;
    }
    t->held = t->gap < t->margin && ( known || leaving <= 0.0f );
    t->is_new = t->held && known == false;
    if ( t->held )
    {
        return true;
    }
    const wisp_vec3 x = wisp_v3_load( f->position + (size_t)slot * 4 ),
                    place = wisp_v3_load( s->place + (size_t)row * 4 );
    const wisp_vec3 there = wisp_v3_mul_add( place, s->spring.dt, wisp_v3_load( s->start + (size_t)row * 4 ) );
    const wisp_vec3 displacement = wisp_v3_mul_add( wisp_v3_sub( there, x ), -f->seconds, t->motion );
    return t->gap >= 0.5f * t->margin && t->gap + wisp_v3_dot( displacement, t->normal ) < 0.0f;
}

// ---- the normals of a row ----

// Merge normals that hardly differ: a held contact wins over a landing one, then the deeper. The deeper comes first.
static int merge( touch* touches, int count )
{
    if ( count < 2 )
    {
        return count;
    }
    const wisp_vec3 t = wisp_v3_cross( touches[0].normal, touches[1].normal );
    const bool is_one = wisp_v3_dot( t, t ) < IMPLICIT_SAME_NORMALS,
               alike = is_one == false || touches[0].held == touches[1].held;
    const bool second = alike ? touches[1].gap < touches[0].gap : touches[1].held;
    if ( second )
    {
        const touch first = touches[0];
        touches[0] = touches[1];
        touches[1] = first;
    }
    return is_one ? 1 : 2;
}

// The vector in the span of the normals that has the given products with them.
static wisp_vec3 spanned( const touch* touches, int count, const float products[WISP_MAX_PARTICLE_CONTACTS] )
{
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f }, n = touches[0].normal;
    if ( count == 1 )
    {
        return wisp_v3_mul_add( none, products[0], n );
    }
    const wisp_vec3 m = touches[1].normal, t = wisp_v3_cross( n, m );
    const float cosine = wisp_v3_dot( n, m ), sine2 = wisp_v3_dot( t, t );
    const wisp_vec3 first = wisp_v3_mul_add( none, ( products[0] - cosine * products[1] ) / sine2, n );
    return wisp_v3_mul_add( first, ( products[1] - cosine * products[0] ) / sine2, m );
}

static wisp_vec3 foreign( const touch* touches, int count, wisp_vec3 v )
{
    const float products[WISP_MAX_PARTICLE_CONTACTS] = { wisp_v3_dot( v, touches[0].normal ),
                                                         wisp_v3_dot( v, touches[count - 1].normal ) };
    return wisp_v3_sub( v, spanned( touches, count, products ) );
}

// Filter of a row that slides.
static void free_across( const touch* touches, int count, float filter[6] )
{
    const wisp_vec3 n = touches[0].normal;
    const float one[6] = { 1.0f - n.x * n.x, -n.x * n.y, -n.x * n.z, 1.0f - n.y * n.y, -n.y * n.z, 1.0f - n.z * n.z };
    memcpy( filter, one, sizeof( one ) );
    if ( count == 2 )
    {
        const wisp_vec3 t = wisp_v3_cross( n, touches[1].normal );
        const float scale = 1.0f / wisp_v3_dot( t, t );
        const float two[6] = { scale * t.x * t.x, scale * t.x * t.y, scale * t.x * t.z,
                               scale * t.y * t.y, scale * t.y * t.z, scale * t.z * t.z };
        memcpy( filter, two, sizeof( two ) );
    }
}

// ---- velocities of a row ----

// Velocity that takes the row along with the surface; x^ may have moved part of the way.
static wisp_vec3 velocity_with( const implicit_system* s, const implicit_contact_input* f, int row, int slot,
                                wisp_vec3 motion )
{
    const wisp_vec3 back =
        wisp_v3_sub( wisp_v3_load( f->position + (size_t)slot * 4 ), wisp_v3_load( s->place + (size_t)row * 4 ) );
    const float rate = 1.0f / s->spring.dt;
    return wisp_v3_mul_add( wisp_v3_mul_add( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, rate, back ), rate * f->seconds,
                            motion );
}

// Rules 3 and 5: distance that the contact moves the particle out of the body, m.
static float way_out( const implicit_contact_input* f, const touch* t )
{
    return t->held ? fminf( fmaxf( 0.0f, -t->gap ), f->seconds * t->recovery ) : 0.5f * t->margin - t->gap;
}

static void prescribe( const implicit_system* s, const implicit_contact_input* f, int row, int slot,
                       const touch* touches, int count, bool sticks )
{
    float products[WISP_MAX_PARTICLE_CONTACTS] = { 0.0f }, filter[6] = { 0.0f };
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 v = velocity_with( s, f, row, slot, touches[i].motion );
        products[i] = wisp_v3_dot( v, touches[i].normal ) + way_out( f, touches + i ) / s->spring.dt;
    }
    wisp_vec3 goal = spanned( touches, count, products );
    if ( sticks )
    {
        const wisp_vec3 v = velocity_with( s, f, row, slot, touches[0].motion );
        goal = wisp_v3_mul_add( goal, 1.0f, foreign( touches, count, v ) );
    }
    else
    {
        free_across( touches, count, filter );
    }
    hold_row( s, row, filter, goal );
}

// Apply friction against the sliding, without reversing it.
static void rub( const implicit_system* s, int row, wisp_vec3 slip, float impulse )
{
    const float speed = wisp_v3_length( slip ), mass = s->place[(size_t)row * 4 + 3];
    float* to = s->rubbing + (size_t)row * 4;
    if ( speed > 0.0f )
    {
        const float fraction = -fminf( impulse, mass * speed ) / speed;
        to[0] = fraction * slip.x;
        to[1] = fraction * slip.y;
        to[2] = fraction * slip.z;
    }
}

typedef struct grip
{
    float holds, brakes; // kg m/s: mu_s and mu_k times the normal impulse
    bool is_new, lands;
} grip;

static grip grip_of( const touch* touches, int count )
{
    grip g = { .is_new = false };
    for ( int i = 0; i < count; ++i )
    {
        const float pressed = touches[i].held ? fmaxf( 0.0f, touches[i].pressed ) : 0.0f;
        g.holds += touches[i].static_friction * pressed;
        g.brakes += touches[i].kinetic_friction * pressed;
        g.is_new = g.is_new || touches[i].is_new;
        g.lands = g.lands || touches[i].held == false;
    }
    return g;
}

// Rule 4.
static void answer( const implicit_system* s, const implicit_contact_input* f, int row, int slot, touch* touches,
                    int count, implicit_counts* counts )
{
    const implicit_contact before = f->contact[slot];
    implicit_contact now = { .slides = 1 };
    for ( int i = 0; i < count; ++i )
    {
        now.body[touches[i].place] = f->body[(size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)touches[i].place];
    }
    count = merge( touches, count );
    const grip g = grip_of( touches, count );
    const wisp_vec3 slip =
        foreign( touches, count, wisp_v3_sub( wisp_v3_load( s->start + (size_t)row * 4 ), touches[0].motion ) );
    const float momentum = s->place[(size_t)row * 4 + 3] * wisp_v3_length( slip );
    const bool grips = before.slides != 0 ? momentum <= g.brakes : before.rubbed <= g.holds;
    const bool sticks = g.lands == false && ( g.is_new || grips );
    prescribe( s, f, row, slot, touches, count, sticks );
    if ( sticks == false && g.lands == false )
    {
        rub( s, row, slip, g.brakes );
    }
    now.slides = sticks ? 0 : 1;
    now.landed = g.lands ? 1 : 0;
    f->contact[slot] = now;
    counts->landing += g.lands ? 1 : 0;
    counts->sticking += sticks ? 1 : 0;
    counts->sliding += sticks == false && g.lands == false ? 1 : 0;
}

void implicit_touch_row( const implicit_system* s, const implicit_contact_input* f, int row, implicit_counts* counts )
{
    const int slot = s->links->row_slot[row];
    memset( s->goal + (size_t)row * 4, 0, 4 * sizeof( float ) );
    memset( s->rubbing + (size_t)row * 4, 0, 4 * sizeof( float ) );
    if ( slot < 0 )
    {
        return;
    }
    if ( f->position[(size_t)slot * 4 + 3] == 0.0f )
    {
        hold_pin( s, f, row, slot );
        return;
    }
    touch touches[WISP_MAX_PARTICLE_CONTACTS];
    int count = 0;
    for ( int place = 0; place < WISP_MAX_PARTICLE_CONTACTS; ++place )
    {
        if ( f->body[(size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)place] != 0 )
        {
            touches[count] = read_touch( f, slot, place );
            count += judge( s, f, row, slot, touches + count, counts ) ? 1 : 0;
        }
    }
    if ( count > 0 )
    {
        answer( s, f, row, slot, touches, count, counts );
    }
    else
    {
        f->contact[slot] = ( implicit_contact ){ .slides = 0 };
    }
}

// Contacts of the last solve.
static int held_touches( const implicit_contact_input* f, int slot, touch touches[WISP_MAX_PARTICLE_CONTACTS] )
{
    int count = 0;
    for ( int place = 0; place < WISP_MAX_PARTICLE_CONTACTS; ++place )
    {
        if ( f->contact[slot].body[place] != 0 )
        {
            touches[count] = read_touch( f, slot, place );
            touches[count++].held = true;
        }
    }
    return count;
}

wisp_vec3 implicit_impulse( const implicit_system* s, int row )
{
    const wisp_vec3 left = read_lanes( (const float( * )[3][WISP_SLICE])s->conjugate.residual, row );
    return wisp_v3_sub( filtered( s, row, left ), left );
}

// Split J by the normals. Merged contacts have all of it each.
void implicit_press_row( const implicit_system* s, const implicit_contact_input* f, int row )
{
    const int slot = s->links->row_slot[row];
    touch touches[WISP_MAX_PARTICLE_CONTACTS];
    const int found = slot >= 0 ? held_touches( f, slot, touches ) : 0;
    if ( found == 0 )
    {
        return;
    }
    implicit_contact* contact = f->contact + slot;
    const wisp_vec3 impulse = implicit_impulse( s, row );
    const int count = merge( touches, found );
    for ( int i = 0; i < found; ++i )
    {
        contact->pressed[touches[i].place] = wisp_v3_dot( impulse, touches[i].normal );
    }
    if ( count == 2 )
    {
        const wisp_vec3 n = touches[0].normal, m = touches[1].normal, t = wisp_v3_cross( n, m );
        const float along = wisp_v3_dot( impulse, n ), other = wisp_v3_dot( impulse, m ),
                    cosine = wisp_v3_dot( n, m ), sine2 = wisp_v3_dot( t, t );
        contact->pressed[touches[0].place] = ( along - cosine * other ) / sine2;
        contact->pressed[touches[1].place] = ( other - cosine * along ) / sine2;
    }
    contact->rubbed = wisp_v3_length( foreign( touches, count, impulse ) );
    // A vertex that would have arrived more slowly was pulled to its landing, with a velocity into the body. It must be stopped
    // there and is released later if at all.
    for ( int place = 0; place < WISP_MAX_PARTICLE_CONTACTS && contact->landed != 0; ++place )
    {
        contact->pressed[place] = fmaxf( 0.0f, contact->pressed[place] );
    }
}

// BDF2 must not extrapolate an impact. So vertices in contact count as having moved with their body, in the held directions.
void implicit_apply_contact_correction( const implicit_contact_input* f, int slot, float* x, float* v,
                                        float* x_before, float* v_before )
{
    touch touches[WISP_MAX_PARTICLE_CONTACTS];
    int count = held_touches( f, slot, touches );
    if ( count == 0 )
    {
        return;
    }
    count = merge( touches, count );
    const wisp_vec3 surface = touches[0].motion, now = wisp_v3_load( x ), was = wisp_v3_load( x_before );
    const float products[WISP_MAX_PARTICLE_CONTACTS] = {
        wisp_v3_dot( surface, touches[0].normal ), wisp_v3_dot( touches[count - 1].motion, touches[count - 1].normal )
    };
    const bool sticks = f->contact[slot].slides == 0;
    const wisp_vec3 along = spanned( touches, count, products ), none = { 0.0f, 0.0f, 0.0f };
    const wisp_vec3 gone = sticks ? wisp_v3_mul_add( none, f->seconds, surface ) : wisp_v3_sub( now, was );
    const wisp_vec3 speed = sticks ? surface : wisp_v3_load( v ),
                    speed_before = sticks ? surface : wisp_v3_load( v_before );
    const wisp_vec3 displacement = wisp_v3_mul_add( foreign( touches, count, gone ), f->seconds, along );
    const wisp_vec3 from = wisp_v3_sub( now, displacement );
    const wisp_vec3 to = wisp_v3_mul_add( along, 1.0f, foreign( touches, count, speed ) );
    const wisp_vec3 to_before = wisp_v3_mul_add( along, 1.0f, foreign( touches, count, speed_before ) );
    memcpy( x_before, &from, sizeof( from ) );
    memcpy( v, &to, sizeof( to ) );
    memcpy( v_before, &to_before, sizeof( to_before ) );
}
