// Cloth that two bodies squeeze. In: the contacts of a block of particles in a substep. Out: the same, loaded.
//
// Where the half spaces of two bodies leave a vertex less room than its thickness h on either side, it cannot keep both. It then is
// held in the middle, and each body presses on it with the force of its depth d, as far as their normals oppose each other:
//
//   d = ( h1 + h2 - d1 - d2 ) / 2,   F = k d max( 0, - n1 n2 ),   k = SQUEEZE m / h,   h = ( h1 + h2 ) / 2
//
// with d1 and d2 the distances of the bodies. Both forces cancel, so they move nothing. They are what the normal corrections of the
// two contacts, F h^2 / m, begin the substep with: friction gets its cone from them, and a constraint that pulls the vertex to one body
// unloads the other first. The middle is taken at the push-out speed, together with the previous position, as other depth is.
//
// Bodies that overlap by more than h1 + h2 squeeze nothing: what is inside of both is moved out of each, as without the other.
//
// SQUEEZE is the load of 5000 weights at the depth of the whole thickness: cloth of 0.2 kg/m^2 loses half of it under 50 gf/cm^2,
// the pressure to which compression is measured (Kawabata 1980, "The standardization and analysis of hand evaluation").
#include "particle_contacts.h"

#include "body_queries.h"
#include "reaction.h"

static const float SQUEEZE = 5000.0f * 9.81f; // m/s^2

float collision_squeeze_load( float dt, float oppose, float depth, float both )
{
    return SQUEEZE * dt * dt * oppose * depth / both;
}

bool collision_is_squeezed( float oppose, float depth, float both )
{
    return oppose > 0.0f && depth > 0.0f && depth <= 2.0f * both;
}

typedef struct squeezed_pair
{
    int first, second;
    float depth, oppose; // m, of both together; - n1 n2
} squeezed_pair;

// Return the pair of contacts that presses the most. Its depth is 0 if none does.
static squeezed_pair find_pair( const collision_contact* c, const float* thickness, int count, wisp_vec3 p )
{
    squeezed_pair best = { 0 };
    float most = 0.0f;
    for ( int j = 1; j < count; ++j )
    {
        for ( int i = 0; i < j; ++i )
        {
            const wisp_vec3 a = wisp_v3_load( c[i].normal ), b = wisp_v3_load( c[j].normal );
            const float apart = wisp_v3_dot( a, wisp_v3_sub( p, wisp_v3_load( c[i].point ) ) ) +
                                wisp_v3_dot( b, wisp_v3_sub( p, wisp_v3_load( c[j].point ) ) );
            const float depth = thickness[i] + thickness[j] - apart, oppose = -wisp_v3_dot( a, b );
            if ( collision_is_squeezed( oppose, depth, thickness[i] + thickness[j] ) && depth * oppose > most )
            {
                most = depth * oppose;
                best = ( squeezed_pair ){ i, j, depth, oppose };
            }
        }
    }
    return best;
}

// Return the distance at the start of the substep, less the thickness.
static float start_of( const collision_contact* c, float thickness, wisp_vec3 previous )
{
    const wisp_vec3 point = wisp_v3_sub( wisp_v3_load( c->point ), wisp_v3_load( c->motion ) );
    return wisp_v3_dot( wisp_v3_load( c->normal ), wisp_v3_sub( previous, point ) ) - thickness;
}

// What moved the vertex out of one body after the other is taken back. The body that took its outward motion gives it again.
static void take_back( const collision_find_args* args, const collision_block* block, int slot,
                       const squeezed_pair* pair )
{
    float *p = args->position + (size_t)slot * 4, *previous = args->previous + (size_t)slot * 4;
    const wisp_vec3 to = wisp_v3_load( block->was[0][slot - block->begin] ),
                    previous_to = wisp_v3_load( block->was[1][slot - block->begin] );
    if ( args->sums != NULL )
    {
        const wisp_vec3 gained =
            wisp_v3_sub( wisp_v3_sub( to, wisp_v3_load( p ) ), wisp_v3_sub( previous_to, wisp_v3_load( previous ) ) );
        const collision_contact* c = args->contact[slot];
        const wisp_vec3 apart =
            wisp_v3_sub( wisp_v3_load( c[pair->first].normal ), wisp_v3_load( c[pair->second].normal ) );
        const int giver = wisp_v3_dot( gained, apart ) > 0.0f ? pair->first : pair->second;
        const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
        collision_add_impulse( args->sums[args->contact_body[slot][giver]], 1.0 / ( (double)p[3] * (double)args->dt ),
                               none, gained, wisp_v3_load( previous ) );
    }
    collision_store( p, to );
    collision_store( previous, previous_to );
}

static void load_pair( const collision_find_args* args, int slot, const squeezed_pair* pair, wisp_vec3 axis,
                       float load )
{
    collision_contact* c = args->contact[slot];
    c[pair->first].normal_correction = c[pair->second].normal_correction = load;
    if ( args->sums != NULL )
    {
        const float* p = args->position + (size_t)slot * 4;
        const double rate = 1.0 / ( (double)p[3] * (double)args->dt );
        const wisp_vec3 none = { 0.0f, 0.0f, 0.0f }, push = wisp_v3_mul_add( none, load, axis );
        const int32_t* body = args->contact_body[slot];
        collision_add_impulse( args->sums[body[pair->first]], rate, none, push, wisp_v3_load( p ) );
        collision_add_impulse( args->sums[body[pair->second]], rate, push, none, wisp_v3_load( p ) );
    }
}

static void squeeze_vertex( const collision_find_args* args, const collision_block* block, int slot, int count )
{
    collision_contact* c = args->contact[slot];
    const float* h = block->thickness[slot - block->begin];
    float *p = args->position + (size_t)slot * 4, *previous = args->previous + (size_t)slot * 4;
    const squeezed_pair pair = find_pair( c, h, count, wisp_v3_load( block->was[0][slot - block->begin] ) );
    const int i = pair.first, j = pair.second;
    if ( pair.depth <= 0.0f )
    {
        return;
    }
    take_back( args, block, slot, &pair );
    // to the middle
    const float along = sqrtf( 0.5f + 0.5f * pair.oppose );
    const wisp_vec3 both = wisp_v3_sub( wisp_v3_load( c[i].normal ), wisp_v3_load( c[j].normal ) ), none = { 0 },
                    axis = wisp_v3_mul_add( none, 0.5f / along, both );
    const wisp_vec3 old = wisp_v3_load( previous );
    const float aside = 0.5f * ( start_of( c + i, h[i], old ) - start_of( c + j, h[j], old ) );
    const float shift = collision_larger( -args->recovery, collision_smaller( -aside / along, args->recovery ) );
    collision_store( p, wisp_v3_mul_add( wisp_v3_load( p ), shift, axis ) );
    collision_store( previous, wisp_v3_mul_add( old, shift, axis ) );
    c[i].gap = h[i] - 0.5f * pair.depth + ( aside + along * shift );
    c[j].gap = h[j] - 0.5f * pair.depth - ( aside + along * shift );
    for ( int k = 0; k < count; ++k )
    {
        c[k].gap = k == i || k == j
                       ? c[k].gap
                       : collision_smaller( h[k], h[k] + start_of( c + k, h[k], wisp_v3_load( previous ) ) );
    }
    load_pair( args, slot, &pair, axis, collision_squeeze_load( args->dt, pair.oppose, pair.depth, h[i] + h[j] ) );
}

void collision_squeeze( const collision_find_args* args, const collision_block* block )
{
    for ( int slot = block->begin; slot < block->end; ++slot )
    {
        const int found = args->count[slot],
                  count = found < WISP_COLLISION_CONTACTS ? found : WISP_COLLISION_CONTACTS;
        if ( count > 1 && args->position[(size_t)slot * 4 + 3] > 0.0f )
        {
            squeeze_vertex( args, block, slot, count );
        }
    }
}

bool collision_find_loaded( const collision_contact* contacts, int count, int* first, int* second )
{
    for ( *second = 1; *second < count; ++*second )
    {
        for ( *first = 0; *first < *second; ++*first )
        {
            const collision_contact *a = contacts + *first, *b = contacts + *second;
            if ( a->normal_correction > 0.0f && b->normal_correction > 0.0f &&
                 wisp_v3_dot( wisp_v3_load( a->normal ), wisp_v3_load( b->normal ) ) < 0.0f )
            {
                return true;
            }
        }
    }
    return false;
}

// A free body of mass M that a stiff load F = k d meets would be thrown in one substep. It gives way by w F h^2 of all vertices near it,
// with w its inverse mass there and c their mass, so the load is that of the depth that is left:
//
//   d' = d - w c a,   a = K d',   K = SQUEEZE h^2 / ( h1 + h2 )   =>   a = K d / ( 1 + K w c )
void collision_unload( wisp_frame* frame, const collision_state* state, wisp_entity e, int32_t body )
{
    const collision_settings* settings = wisp_frame_column( frame, e, state->settings, 0 );
    const float* position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 );
    const int32_t* count = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 0 );
    collision_contact( *contact )[WISP_COLLISION_CONTACTS] =
        wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 2 );
    int32_t( *of )[WISP_COLLISION_CONTACTS] = wisp_frame_column( frame, e, state->contact_body, 0 );
    const float dt = wisp_frame_dt( frame, e );
    const int slots = of != NULL ? wisp_frame_fabric( frame, e )->slot_count : 0;
    for ( int slot = 0; slot < slots; ++slot )
    {
        int pair[2];
        const int used = count[slot] < WISP_COLLISION_CONTACTS ? count[slot] : WISP_COLLISION_CONTACTS;
        if ( used < 2 || collision_find_loaded( contact[slot], used, pair, pair + 1 ) == false ||
             ( of[slot][pair[0]] != body && of[slot][pair[1]] != body ) )
        {
            continue;
        }
        float both = 2.0f * settings->thickness;
        for ( int i = 0; i < 2; ++i )
        {
            const wisp_entity other = state->bodies[of[slot][pair[i]]].entity;
            both += ( (const collision_collider*)wisp_frame_column( frame, other, state->collider, 0 ) )->thickness;
        }
        collision_contact* c[2] = { contact[slot] + pair[0], contact[slot] + pair[1] };
        const wisp_vec3 p = wisp_v3_load( position + (size_t)slot * 4 );
        const wisp_vec3 apart = wisp_v3_sub( wisp_v3_load( c[0]->normal ), wisp_v3_load( c[1]->normal ) );
        const float share = collision_share_of( frame, state, body, e, p,
                                                wisp_v3_load( c[of[slot][pair[0]] == body ? 0 : 1]->normal ) )
                                .normal;
        // share = 1 / ( 1 + w c )
        const float load = c[0]->normal_correction,
                    gives = collision_squeeze_load( dt, 1.0f, 1.0f, both ) * ( 1.0f / share - 1.0f );
        c[0]->normal_correction = c[1]->normal_correction = load / ( 1.0f + gives );
        const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
        const wisp_vec3 less =
            wisp_v3_mul_add( none, ( load - c[0]->normal_correction ) / wisp_v3_length( apart ), apart );
        const double rate = 1.0 / ( (double)position[(size_t)slot * 4 + 3] * (double)dt );
        collision_impulse* sums = collision_reaction_sums( frame, e, state, slot / COLLISION_BLOCK );
        collision_add_impulse( sums[of[slot][pair[0]]], rate, less, none, p );
        collision_add_impulse( sums[of[slot][pair[1]]], rate, none, less, p );
    }
}
