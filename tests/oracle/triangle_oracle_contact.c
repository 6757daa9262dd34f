// Contact of vertices with bodies: hold, release, stick, slide, land. Section 5, C1 to C4, as the rules 1 to 5 of
// modules/implicit_cloth/README.md order them.
#include "triangle_oracle.h"

static const double3 zero = { 0.0, 0.0, 0.0 };

// ---- bodies ----

// A vertex at the centre of a sphere has no nearest way out, so it is not touched.
static bool touches( const triangle_oracle_body* body, int name, int vertex, double3 x, triangle_oracle_touch* touch )
{
    const double3 way = double3_sub( x, body->place );
    const double distance = double3_length( way );
    *touch = ( triangle_oracle_touch ){
        .body = name,
        .motion = body->velocity,
        .margin = body->margin,
        .still = body->still,
        .slip = body->slip,
        .recovery = body->recovery,
    };
    if ( body->shape == TRIANGLE_ORACLE_GIVEN )
    {
        return body->touch( body->user, vertex, x, touch );
    }
    const bool plane = body->shape == TRIANGLE_ORACLE_PLANE;
    touch->normal = plane ? body->normal : double3_scale( 1.0 / distance, way );
    touch->gap = plane ? double3_dot( way, body->normal ) : distance - body->radius;
    return plane || distance > 0.0;
}

// The two bodies with the smallest gaps, the deeper first.
static int nearest( const triangle_oracle_bodies* bodies, int vertex, double3 x, triangle_oracle_touch* found )
{
    int count = 0;
    for ( int k = 0; bodies != NULL && k < bodies->count; ++k )
    {
        triangle_oracle_touch touch;
        if ( !touches( bodies->body + k, k + 1, vertex, x, &touch ) )
        {
            continue;
        }
        if ( count < TRIANGLE_ORACLE_TOUCHES )
        {
            found[count++] = touch;
        }
        else if ( touch.gap < found[1].gap )
        {
            found[1] = touch;
        }
        if ( count == 2 && found[1].gap < found[0].gap )
        {
            const triangle_oracle_touch deeper = found[1];
            found[1] = found[0];
            found[0] = deeper;
        }
    }
    return count;
}

// ---- normals ----

// The normals in use: of two along one line only that of the deeper contact.
typedef struct frame
{
    int count;
    int index[TRIANGLE_ORACLE_TOUCHES]; // of the contact
    double3 n[TRIANGLE_ORACLE_TOUCHES];
} frame;

static frame frame_of( const triangle_oracle_touch* touch, int count )
{
    frame f = { .count = count, .index = { 0, 1 } };
    for ( int k = 0; k < count; ++k )
    {
        f.n[k] = touch[k].normal;
    }
    if ( count == 2 && double3_length( double3_cross( f.n[0], f.n[1] ) ) < 1e-3 )
    {
        f.index[0] = touch[1].gap < touch[0].gap ? 1 : 0;
        f.n[0] = touch[f.index[0]].normal;
        f.count = 1;
    }
    return f;
}

// The vector in the span of the normals with the given products with them, as coefficients of the normals.
static void fractions_of( const frame* f, const double* products, double* fractions )
{
    const double both = f->count == 2 ? double3_dot( f->n[0], f->n[1] ) : 0.0;
    const double determinant = 1.0 - both * both;
    fractions[0] = fractions[1] = 0.0;
    for ( int k = 0; k < f->count; ++k )
    {
        const double other = f->count == 2 ? products[1 - k] : 0.0;
        fractions[k] = ( products[k] - both * other ) / determinant;
    }
}

static double3 spanned( const frame* f, const double* products )
{
    double fractions[TRIANGLE_ORACLE_TOUCHES];
    double3 sum = zero;
    fractions_of( f, products, fractions );
    for ( int k = 0; k < f->count; ++k )
    {
        sum = double3_add_scaled( sum, fractions[k], f->n[k] );
    }
    return sum;
}

static double3 along_normals( const frame* f, double3 v )
{
    double products[TRIANGLE_ORACLE_TOUCHES] = { 0.0, 0.0 };
    for ( int k = 0; k < f->count; ++k )
    {
        products[k] = double3_dot( v, f->n[k] );
    }
    return spanned( f, products );
}

static double3 across_normals( const frame* f, double3 v )
{
    return double3_sub( v, along_normals( f, v ) );
}

// Column by column: the part of an axis across the normals.
static triangle_oracle_matrix freedom_of( const frame* f )
{
    triangle_oracle_matrix s;
    for ( int column = 0; column < 3; ++column )
    {
        const double3 v = across_normals( f, double3_make( column == 0, column == 1, column == 2 ) );
        s.m[0][column] = v.x;
        s.m[1][column] = v.y;
        s.m[2][column] = v.z;
    }
    return s;
}

// ---- results of the last solve ----

// Impulse of the last solve at the contacts that stay: the limit of friction, and friction itself.
typedef struct grip
{
    double still, slip; // N s, mu_s J_n and mu_k J_n
    double across;      // N s, |J_t|
} grip;

// J is split by the normals of that solve.
static grip grip_of( const triangle_oracle_touch* touch, int count, double3 impulse )
{
    const frame f = frame_of( touch, count );
    double products[TRIANGLE_ORACLE_TOUCHES] = { 0.0, 0.0 }, fractions[TRIANGLE_ORACLE_TOUCHES];
    for ( int k = 0; k < f.count; ++k )
    {
        products[k] = double3_dot( impulse, f.n[k] );
    }
    fractions_of( &f, products, fractions );
    grip g = { .across = double3_length( across_normals( &f, impulse ) ) };
    for ( int k = 0; k < f.count; ++k )
    {
        g.still += touch[f.index[k]].still * fmax( fractions[k], 0.0 );
        g.slip += touch[f.index[k]].slip * fmax( fractions[k], 0.0 );
    }
    return g;
}

// ---- states ----

// State of a substep for contact.
typedef struct moment
{
    double h, s;
    double3 gone;  // m, motion of the vertex apart from s v+: x^ - x
    double3 v;     // m/s, at the start of the substep
    double3 v_hat; // m/s
} moment;

static double approach( const moment* now, const triangle_oracle_touch* touch )
{
    return double3_dot( double3_sub( now->v, touch->motion ), touch->normal );
}

// The gap at the end of the substep if the vertex moves with v^.
static double gap_ahead( const moment* now, const triangle_oracle_touch* touch )
{
    const double3 way =
        double3_add_scaled( double3_add_scaled( now->gone, now->s, now->v_hat ), -now->h, touch->motion );
    return touch->gap + double3_dot( way, touch->normal );
}

static int find( const triangle_oracle_contact* contact, int body )
{
    for ( int k = 0; k < contact->count; ++k )
    {
        if ( contact->touch[k].body == body )
        {
            return k;
        }
    }
    return -1;
}

// Rules 1 to 3 for one body: whether and how it holds the vertex in this substep.
typedef enum hold
{
    HOLD_NOT,
    HOLD_RELEASED, // released, because it would have had to pull
    HOLD_STAYS,
    HOLD_NEW,
    HOLD_LANDS,
} hold;

// Whether the body would have had to pull more than what stops the vertex, if recovery had set it in motion.
static bool lets_go_of( const triangle_oracle_contact* last, int at, double mass, double leaving )
{
    return last->pulls[at] && last->normal_impulse[at] < -( last->slack + mass * fmax( 0.0, leaving ) );
}

static hold hold_of( const triangle_oracle* cloth, int vertex, const moment* now, const triangle_oracle_touch* touch )
{
    const triangle_oracle_contact* last = cloth->contact + vertex;
    const int before = find( last, touch->body );
    const bool near = touch->gap < touch->margin;
    // A vertex that was just released must neither be held again nor land in the same substep: its velocity is still
    // the body's, so both rules would hold it for ever.
    if ( before >= 0 && lets_go_of( last, before, cloth->mass[vertex], approach( now, touch ) ) )
    {
        return HOLD_RELEASED;
    }
    if ( near && before >= 0 )
    {
        return HOLD_STAYS;
    }
    if ( near && approach( now, touch ) <= 0.0 )
    {
        return HOLD_NEW;
    }
    const bool lands = touch->gap >= 0.5 * touch->margin && gap_ahead( now, touch ) < 0.0;
    return cloth->params.speculative && lands ? HOLD_LANDS : HOLD_NOT;
}

// Rules 1 to 4: the contacts of this substep, and whether the vertex sticks. @param g result of the last solve
static triangle_oracle_contact hold_vertex( triangle_oracle* cloth, int vertex, const moment* now,
                                            const triangle_oracle_bodies* bodies, grip* g )
{
    const triangle_oracle_contact* last = cloth->contact + vertex;
    triangle_oracle_contact next = { .state = TRIANGLE_ORACLE_FREE };
    triangle_oracle_touch found[TRIANGLE_ORACLE_TOUCHES], stay[TRIANGLE_ORACLE_TOUCHES];
    const int found_count = nearest( bodies, vertex, cloth->x[vertex], found );
    int stay_count = 0;
    bool comes = false, lands = false, lets_go = false;
    for ( int k = 0; k < found_count; ++k )
    {
        const hold how = hold_of( cloth, vertex, now, found + k );
        comes = comes || how == HOLD_NEW;
        lands = lands || how == HOLD_LANDS;
        lets_go = lets_go || how == HOLD_RELEASED;
        if ( how == HOLD_STAYS )
        {
            stay[stay_count++] = last->touch[find( last, found[k].body )];
        }
        if ( how >= HOLD_STAYS )
        {
            next.lands[next.count] = how == HOLD_LANDS;
            next.touch[next.count++] = found[k];
        }
    }
    cloth->released += lets_go ? 1 : 0;
    *g = grip_of( stay, stay_count, cloth->impulse[vertex] );
    if ( next.count == 0 )
    {
        return next;
    }
    const frame f = frame_of( next.touch, next.count );
    const double3 slip = across_normals( &f, double3_sub( now->v_hat, next.touch[f.index[0]].motion ) );
    const bool stuck = last->state == TRIANGLE_ORACLE_STICKING;
    const bool grips = stuck ? g->across <= g->still : cloth->mass[vertex] * double3_length( slip ) <= g->slip;
    const bool sticks = comes || grips;
    next.state = lands ? TRIANGLE_ORACLE_LANDING : sticks ? TRIANGLE_ORACLE_STICKING : TRIANGLE_ORACLE_SLIDING;
    return next;
}

// ---- prescribed motion ----

// Rule 5, and rule 3 for a landing vertex: how far it moves out of the body beyond the motion of the surface.
static double way_out( const moment* now, const triangle_oracle_touch* touch, bool lands )
{
    if ( lands )
    {
        return 0.5 * touch->margin - touch->gap;
    }
    return touch->gap < 0.0 ? fmin( -touch->gap, touch->recovery * now->h ) : 0.0;
}

// The velocity at the end of a vertex that moved with a surface, and out of it. With BDF2 x^ is not x, so the part of
// x^ already counts; with Euler this is the surface's velocity and `out / h`.
static double3 velocity_with( const moment* now, double3 surface, double3 out )
{
    return double3_add_scaled( double3_scale( now->h / now->s, surface ), 1.0 / now->s,
                               double3_sub( out, now->gone ) );
}

static void prescribe( triangle_oracle* cloth, int vertex, const moment* now, const grip* g )
{
    const triangle_oracle_contact* contact = cloth->contact + vertex;
    const frame f = frame_of( contact->touch, contact->count );
    double products[TRIANGLE_ORACLE_TOUCHES] = { 0.0, 0.0 };
    for ( int k = 0; k < f.count; ++k )
    {
        const int at = f.index[k];
        const triangle_oracle_touch* touch = contact->touch + at;
        const double3 out = double3_scale( way_out( now, touch, contact->lands[at] ), f.n[k] );
        products[k] = double3_dot( velocity_with( now, touch->motion, out ), f.n[k] );
    }
    const double3 surface = contact->touch[f.index[0]].motion;
    const double3 along = spanned( &f, products );
    cloth->freedom[vertex] = freedom_of( &f );
    cloth->prescribed[vertex] = along;
    if ( contact->state == TRIANGLE_ORACLE_STICKING )
    {
        const double3 across = across_normals( &f, velocity_with( now, surface, zero ) );
        cloth->freedom[vertex] = ( triangle_oracle_matrix ){ { { 0.0 } } };
        cloth->prescribed[vertex] = double3_add( along, across );
    }
    const double3 slip = across_normals( &f, double3_sub( now->v_hat, surface ) );
    const double speed = double3_length( slip );
    if ( contact->state == TRIANGLE_ORACLE_SLIDING && speed > 0.0 )
    {
        const double impulse = fmin( g->slip, cloth->mass[vertex] * speed );
        cloth->push[vertex] = double3_scale( -impulse / speed, slip );
    }
}

void triangle_oracle_contact_begin( triangle_oracle* cloth, double h, double s, const double3* x_hat,
                                    const double3* v_hat, const triangle_oracle_bodies* bodies )
{
    cloth->released = 0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        grip g;
        const moment now = { h, s, double3_sub( x_hat[i], cloth->x[i] ), cloth->v[i], v_hat[i] };
        cloth->push[i] = zero;
        cloth->prescribed[i] = v_hat[i];
        cloth->freedom[i] = ( triangle_oracle_matrix ){ { { 0.0 } } };
        if ( cloth->pinned[i] )
        {
            cloth->contact[i] = ( triangle_oracle_contact ){ .state = TRIANGLE_ORACLE_FREE };
            continue;
        }
        cloth->contact[i] = hold_vertex( cloth, i, &now, bodies, &g );
        if ( cloth->contact[i].state == TRIANGLE_ORACLE_FREE )
        {
            cloth->freedom[i].m[0][0] = cloth->freedom[i].m[1][1] = cloth->freedom[i].m[2][2] = 1.0;
        }
        else
        {
            prescribe( cloth, i, &now, &g );
        }
    }
}

// ---- after the solve ----

// J split by the normals. Where two normals count as one, both contacts receive all of it.
static void split( const triangle_oracle* cloth, int vertex, triangle_oracle_contact* contact )
{
    const frame f = frame_of( contact->touch, contact->count );
    double products[TRIANGLE_ORACLE_TOUCHES] = { 0.0, 0.0 };
    for ( int k = 0; k < contact->count; ++k )
    {
        products[k] = double3_dot( cloth->impulse[vertex], contact->touch[k].normal );
    }
    if ( f.count == contact->count )
    {
        fractions_of( &f, products, contact->normal_impulse );
        return;
    }
    for ( int k = 0; k < contact->count; ++k )
    {
        contact->normal_impulse[k] = products[k];
    }
}

void triangle_oracle_contact_end( triangle_oracle* cloth, double h )
{
    int counts[TRIANGLE_ORACLE_LANDING + 1] = { 0 };
    for ( int i = 0; i < cloth->count; ++i )
    {
        triangle_oracle_contact* contact = cloth->contact + i;
        const double weight = cloth->mass[i] * double3_length( cloth->params.gravity );
        split( cloth, i, contact );
        contact->slack = cloth->params.release_hysteresis * weight * h;
        for ( int k = 0; k < contact->count; ++k )
        {
            // a vertex that was pulled to its landing point moves into the body and has to be stopped first
            const bool landed = contact->state == TRIANGLE_ORACLE_LANDING;
            contact->pulls[k] = !landed && contact->normal_impulse[k] < -contact->slack;
        }
        ++counts[contact->state];
    }
    cloth->sticking = counts[TRIANGLE_ORACLE_STICKING];
    cloth->sliding = counts[TRIANGLE_ORACLE_SLIDING];
    cloth->landing = counts[TRIANGLE_ORACLE_LANDING];
}

void triangle_oracle_contact_settle( triangle_oracle* cloth, double h )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        const triangle_oracle_contact* contact = cloth->contact + i;
        if ( contact->state == TRIANGLE_ORACLE_FREE )
        {
            continue;
        }
        const frame f = frame_of( contact->touch, contact->count );
        const double3 surface = contact->touch[f.index[0]].motion;
        double products[TRIANGLE_ORACLE_TOUCHES] = { 0.0, 0.0 };
        for ( int k = 0; k < f.count; ++k )
        {
            products[k] = double3_dot( contact->touch[f.index[k]].motion, f.n[k] );
        }
        const double3 along = spanned( &f, products );
        const double3 way = double3_sub( cloth->x[i], cloth->x_before[i] );
        const bool sticks = contact->state == TRIANGLE_ORACLE_STICKING;
        const double3 v = sticks ? surface : cloth->v[i], v_before = sticks ? surface : cloth->v_before[i];
        const double3 gone = sticks ? double3_scale( h, surface ) : way;
        cloth->v[i] = double3_add( along, across_normals( &f, v ) );
        cloth->v_before[i] = double3_add( along, across_normals( &f, v_before ) );
        const double3 whole = double3_add_scaled( across_normals( &f, gone ), h, along );
        cloth->x_before[i] = double3_sub( cloth->x[i], whole );
    }
}
