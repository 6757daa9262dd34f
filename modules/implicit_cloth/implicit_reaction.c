// What implicit cloth gives to bodies. In: impulses of the last solve. Out: particle.contact_impulses, of which collision makes
// reactions. The impulse of a solve acts for the time of its equations, 2/3 h with BDF2; what settles the history of BDF2 after an
// impact takes momentum too (implicit_settle_row).
#include "implicit_internal.h"

wisp_vec3 implicit_momentum( const implicit_contact_input* f, int slot, const float* v, const float* v_before )
{
    const float weight = f->position[(size_t)slot * 4 + 3], mass = weight > 0.0f ? 1.0f / weight : 0.0f;
    float p[3];
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = mass * ( v_before != NULL ? 1.5f * v[k] - 0.5f * v_before[k] : v[k] );
    }
    return ( wisp_vec3 ){ p[0], p[1], p[2] };
}

// The share of the second of two bodies: what presses along its normal. The first has the rest, friction included.
static wisp_vec3 share_of_second( const implicit_contact_input* f, int slot, float scale )
{
    const float *n = f->plane + (size_t)slot * 4 * WISP_MAX_PARTICLE_CONTACTS, *m = n + 4;
    const float x = n[1] * m[2] - n[2] * m[1], y = n[2] * m[0] - n[0] * m[2], z = n[0] * m[1] - n[1] * m[0];
    const float pressed = x * x + y * y + z * z < IMPLICIT_SAME_NORMALS ? 0.0f : scale * f->contact[slot].pressed[1];
    return ( wisp_vec3 ){ pressed * m[0], pressed * m[1], pressed * m[2] };
}

static void put( const implicit_given* given, size_t at, int32_t body, float x, float y, float z )
{
    given->body[at] = body;
    given->impulse[3 * at] = -x;
    given->impulse[3 * at + 1] = -y;
    given->impulse[3 * at + 2] = -z;
}

void implicit_give_row( const implicit_system* s, const implicit_contact_input* f, const implicit_given* given,
                        int row, wisp_vec3 settled, const float* from )
{
    const int slot = s->links->row_slot[row];
    const implicit_contact* contact = f->contact + slot;
    if ( contact->body[0] == 0 && contact->body[1] == 0 )
    {
        return;
    }
    const float scale = given->per_solve / s->links->fraction[row];
    const float* rubbing = s->rubbing + (size_t)row * 4;
    const wisp_vec3 held = implicit_impulse( s, row );
    const float x = scale * ( held.x + rubbing[0] ) + settled.x, y = scale * ( held.y + rubbing[1] ) + settled.y,
                z = scale * ( held.z + rubbing[2] ) + settled.z;
    const size_t first = (size_t)slot * WISP_MAX_PARTICLE_CONTACTS;
    if ( contact->body[0] == 0 || contact->body[1] == 0 )
    {
        const size_t place = contact->body[0] != 0 ? 0 : 1;
        put( given, first + place, contact->body[place], x, y, z );
    }
    else
    {
        const wisp_vec3 second = share_of_second( f, slot, scale );
        put( given, first, contact->body[0], x - second.x, y - second.y, z - second.z );
        put( given, first + 1, contact->body[1], second.x, second.y, second.z );
    }
    for ( int k = 0; k < 3; ++k )
    {
        given->point[(size_t)slot * 3 + (size_t)k] = from[k];
    }
}
