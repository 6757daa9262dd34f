// Coarse sheets that carry a surface. The coarsest one is integrated to second order in substeps of its own and has
// enough passes to propagate tension across the surface. Its displacement, beyond that of the predicted surface, is
// prolonged to the next finer sheet, which is projected once, and so on down to the surface. What follows is an ordinary substep of
// the surface. At its end, the surface gets what second order adds to the velocity of the coarsest sheet.
#include "passes.h"

#include "wisp/module/components.h"
#include <string.h>

// Columns of surface.levels.
typedef struct levels_columns
{
    int32_t *substeps, *passes, *state, *pins;
    float *forced, *drift;
} levels_columns;

// A pinned vertex of the surface between rows of a sheet.
typedef struct levels_pin
{
    int32_t row_x4[WISP_FABRIC_PARENTS];
    float weight[WISP_FABRIC_PARENTS];
    float scale;             // kg, 1 / sum of weight^2 inverse mass
    float from[3], moved[3]; // m, the point when the substep begins, and how far it moves in the substep
} levels_pin;

// A sheet whose links are projected.
typedef struct levels_sheet
{
    const wisp_fabric_level* level;
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    wisp_level_link_args links;
    const levels_pin* pins;
    int pin_count;
    float pin_fraction; // of the substep of the surface that ends now
} levels_sheet;

// Index of parent k of a row of the next finer sheet in the parents and weights of a level.
static size_t levels_parent_at( int finer_row, int k )
{
    return (size_t)( ( finer_row / 8 * WISP_FABRIC_PARENTS + k ) * 8 + finer_row % 8 );
}

// A surface with coarse sheets, in a substep.
typedef struct levels_surface
{
    const wisp_fabric* fabric;
    const float* position;     // [slot][4] m, where the surface has been predicted, inverse mass in 1/kg
    const float* previous;     // [slot][4] m, where the substep begins
    const float* inverse_mass; // [row] 1/kg, of all levels
} levels_surface;

static const wisp_fabric_level* levels_coarsest( const wisp_fabric* f )
{
    return f->levels + f->level_count - 1;
}

static levels_columns levels_columns_of( wisp_frame* frame, wisp_entity entity )
{
    return ( levels_columns ){
        .substeps = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 0 ),
        .passes = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 1 ),
        .state = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 2 ),
        .pins = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 3 ),
        .forced = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 4 ),
        .drift = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 5 ),
    };
}

static levels_surface levels_surface_of( wisp_frame* frame, wisp_entity entity )
{
    return ( levels_surface ){
        .fabric = wisp_frame_fabric( frame, entity ),
        .position = wisp_frame_column( frame, entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .inverse_mass = wisp_frame_column( frame, entity, WISP_LEVEL_MASS, 0 ),
    };
}

// Copy what the vertices of a level have. @param from [slot][4] @param to [row][4]
static void levels_gather_rows( const wisp_fabric_level* level, const float* from, float* to )
{
    for ( int row = 0; row < level->row_count; ++row )
    {
        memcpy( to + 4 * row, from + level->slot_x4[row], 4 * sizeof( float ) );
    }
}

// Find the mean over masses. @param inverse_mass 1/kg, one in `stride` @param value [count][4]
static void levels_find_mean( const float* inverse_mass, int stride, const float* value, int count, float mean[3] )
{
    double mass = 0.0, sum[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        const float w = inverse_mass[i * stride];
        const double m = w > 0.0f ? 1.0 / (double)w : 0.0;
        mass += m;
        for ( int k = 0; k < 3; ++k )
        {
            sum[k] += m * (double)value[4 * i + k];
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        mean[k] = mass > 0.0 ? (float)( sum[k] / mass ) : 0.0f;
    }
}

// ---- pins ----

// Pins between the rows of a coarse sheet. A pinned vertex of the surface that is no row of the sheet is a point of it: the mean
// of the rows that it follows, by their weights. A sheet that is held nowhere would fall and take the surface along, so the point
// moves with the pin, after every pass over the links.
//
// On a sheet that is not the finest, the point is that of the row of the next finer sheet which the pin follows most.

static int heaviest_parent( const wisp_fabric_level* level, int finer_row )
{
    int best = -1;
    float weight = 0.0f;
    for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
    {
        const size_t at = levels_parent_at( finer_row, k );
        if ( level->weight[at] > weight )
        {
            best = level->parent_x4[at] / 4;
            weight = level->weight[at];
        }
    }
    return best;
}

// @return the row of the next finer sheet that stands for a pin; the slot itself on the finest one; -1 if there is none, or if the
// row is pinned and stands for itself
static int find_finer_row( const levels_surface* s, int number, int slot )
{
    int row = slot;
    for ( int l = 0; l < number && row >= 0; ++l )
    {
        const wisp_fabric_level* level = s->fabric->levels + l;
        row = heaviest_parent( level, row );
        const bool own = row >= 0 && level->slot_x4[row] == 4 * slot;
        row = own || row < 0 || s->position[level->slot_x4[row] + 3] > 0.0f ? row : -1;
    }
    return row;
}

static bool make_pin( const levels_surface* s, int number, int slot, levels_pin* pin )
{
    const wisp_fabric_level* level = s->fabric->levels + number;
    const float* inverse_mass = s->inverse_mass + level->first_row;
    const int finer_row = find_finer_row( s, number, slot );
    float sum = 0.0f;
    *pin = ( levels_pin ){ 0 };
    for ( int k = 0; k < WISP_FABRIC_PARENTS && finer_row >= 0; ++k )
    {
        const size_t at = levels_parent_at( finer_row, k );
        const float weight = level->weight[at];
        const int32_t row_x4 = level->parent_x4[at];
        const float* previous = s->previous + level->slot_x4[row_x4 / 4];
        pin->row_x4[k] = row_x4;
        pin->weight[k] = weight;
        sum += weight * weight * inverse_mass[row_x4 / 4];
        for ( int axis = 0; axis < 3; ++axis )
        {
            pin->from[axis] += weight * previous[axis];
        }
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        pin->moved[axis] = s->position[4 * slot + axis] - s->previous[4 * slot + axis];
    }
    pin->scale = sum > 0.0f ? 1.0f / sum : 0.0f;
    return sum > 0.0f;
}

// List the pins between rows of a level that moves. @param pins [room] @return their number, which may exceed the room
static int levels_find_pins( const levels_surface* s, int number, levels_pin* pins, int room )
{
    int count = 0;
    for ( int slot = 0; slot < s->fabric->vertex_count; ++slot )
    {
        levels_pin pin;
        if ( s->position[4 * slot + 3] <= 0.0f && make_pin( s, number, slot, &pin ) )
        {
            if ( count < room )
            {
                pins[count] = pin;
            }
            count += 1;
        }
    }
    return count;
}

// Move the points of all pins to where these are.
static void levels_project_pins( const levels_sheet* sheet )
{
    float* position = sheet->links.position;
    for ( const levels_pin* p = sheet->pins; p < sheet->pins + sheet->pin_count; ++p )
    {
        for ( int axis = 0; axis < 3; ++axis )
        {
            float error = -( p->from[axis] + sheet->pin_fraction * p->moved[axis] );
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                error += p->weight[k] * position[p->row_x4[k] + axis];
            }
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                float* row = position + p->row_x4[k];
                row[axis] -= p->scale * p->weight[k] * row[3] * error;
            }
        }
    }
}

// ---- restart ----

// Coarse sheets that begin: their masses, velocities and pins.

// Adds the masses of the next finer rows to those that carry them.
static void add_masses( const wisp_fabric_level* level, const double* finer, double* mass )
{
    memset( mass, 0, (size_t)level->row_count * sizeof( double ) );
    for ( int row = 0; row < level->finer_row_count; ++row )
    {
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const size_t at = levels_parent_at( row, k );
            mass[level->parent_x4[at] / 4] += (double)level->weight[at] * finer[row];
        }
    }
}

// Finds the inverse masses of all levels. A coarse vertex is pinned where the surface is.
static bool find_masses( wisp_frame* frame, const wisp_span* span )
{
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* inverse_mass = wisp_frame_column( frame, span->entity, WISP_LEVEL_MASS, 0 );
    const size_t room = ( (size_t)f->slot_count + (size_t)f->levels[0].row_count ) * sizeof( double );
    double* finer = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, room );
    if ( finer == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the coarse sheets of %d particles",
                         f->slot_count );
        return false;
    }
    double* mass = finer + f->slot_count;
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        const double w = (double)position[4 * slot + 3];
        finer[slot] = w > 0.0 ? 1.0 / w : 0.0;
    }
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = f->levels + l;
        add_masses( level, finer, mass );
        for ( int row = 0; row < level->row_count; ++row )
        {
            const bool moves =
                row < level->vertex_count && position[level->slot_x4[row] + 3] > 0.0f && mass[row] > 0.0;
            finer[row] = moves ? mass[row] : 0.0;
            inverse_mass[level->first_row + row] = moves ? (float)( 1.0 / mass[row] ) : 0.0f;
        }
    }
    return true;
}

static bool levels_have_restarted( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return *levels_columns_of( frame, entity ).state == LEVELS_RESTARTED;
}

// @return the most pins between rows that a level has
static int count_pins( const levels_surface* s )
{
    int most = 0;
    for ( int l = 0; l < s->fabric->level_count; ++l )
    {
        const int count = levels_find_pins( s, l, NULL, 0 );
        most = count > most ? count : most;
    }
    return most;
}

// Forget the history. Velocities are those before the forces of this step.
static void levels_restart( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const levels_columns columns = levels_columns_of( frame, span->entity );
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    if ( find_masses( frame, span ) )
    {
        const float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
        levels_gather_rows( levels_coarsest( f ), velocity,
                            wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 0 ) );
        levels_gather_rows( levels_coarsest( f ), velocity,
                            wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 4 ) );
        const levels_surface surface = levels_surface_of( frame, span->entity );
        levels_find_mean( surface.position + 3, 4, velocity, f->slot_count, columns.drift );
        *columns.pins = count_pins( &surface );
        *columns.state = LEVELS_FIRST;
    }
}

// ---- levels ----

enum
{
    GROUP_GRAIN = 64,        // groups of eight links per block
    LEVEL_SLICE_GRAIN = 128, // slices of eight rows per block
};

// Over-relaxation of a projection. Ten passes with it bring a sheet of 17 x 17 rows as far as thirteen without.
#define RELAXATION 1.5f
// Length of a substep, s, below which it is less, in proportion. Sheets and surface never quite agree, and would push each other with
// a velocity that grows as substeps get shorter.
#define LONG_SUBSTEP ( 1.0f / 120.0f )
#define HELD_RATE 0.3f // 1/s, of shortening that links hold up

// ---- links ----

WISP_KERNEL_RANGE( levels_sheet, run_band, level_band, links, 8 )

// Find the lengths below which links push, for a sheet that has been predicted.
static void levels_find_band( levels_sheet* sheet )
{
    wisp_parallel_for( sheet->parallel, sheet->level->chain_group_count, GROUP_GRAIN, run_band, sheet );
}

static void run_level_links( const void* context, int begin, int end )
{
    const levels_sheet* sheet = context;
    sheet->kernels->level_link( &sheet->links, begin, end );
}

// Project all links from multipliers of 0, and pins after each pass. @param dt s
static void levels_project( levels_sheet* sheet, float dt, int passes )
{
    sheet->links.inverse_dt2 = 1.0f / ( dt * dt );
    sheet->kernels->level_prepare( &sheet->links, 0, sheet->level->schedule.slot_count );
    for ( int pass = 0; pass < passes; ++pass )
    {
        wisp_run_schedule( sheet->parallel, &sheet->level->schedule, run_level_links, sheet );
        levels_project_pins( sheet );
    }
}

// ---- coarsest sheet ----

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

// Fraction of the mean link by which a remembered acceleration may move a row.
#define MAX_REMEMBERED 0.1f
// Times its rest length at which a link is torn: its ends were moved apart, and what the sheet would do is of no use to the surface.
#define TORN 100.0f

// The coarsest sheet in a substep of the surface.
typedef struct levels_carrier
{
    levels_sheet sheet;
    // Rows. position: in: where the substep begins; out: where the sheet ends it. acceleration: by the forces on the surface. velocity: in: of the
    // surface, before its forces; out: of the sheet. target: where the surface has been predicted.
    wisp_level_rows_args rows;
    float dt; // s, of the surface
    levels_columns columns;
} levels_carrier;

// Move the coarsest sheet by its substeps. @return false, and nothing has moved, if a link is torn
static bool levels_move_carrier( levels_carrier* c )
{
    const int count = *c->columns.substeps, rows = c->sheet.level->row_count;
    const wisp_kernels* kernels = c->sheet.kernels;
    if ( kernels->level_is_torn( &c->sheet.links, TORN, 0, c->sheet.level->schedule.slot_count ) )
    {
        return false;
    }
    wisp_level_rows_args args = c->rows;
    args.dt = c->dt / (float)count;
    args.most_change = MAX_REMEMBERED * c->sheet.level->mean_rest / ( c->dt * c->dt );
    args.most_added = 0.5f * args.most_change * c->dt;
    for ( int j = 0; j < count; ++j )
    {
        args.is_second_order = *c->columns.state == LEVELS_MOVING;
        args.solve_dt = args.is_second_order ? args.dt * 2.0f / 3.0f : args.dt;
        args.progress = 1.0f / (float)( count - j );
        kernels->level_predict( &args, 0, rows );
        if ( j == 0 )
        {
            levels_find_band( &c->sheet );
        }
        c->sheet.pin_fraction = (float)( j + 1 ) / (float)count;
        levels_project( &c->sheet, args.solve_dt, *c->columns.passes );
        kernels->level_finish( &args, 0, rows );
        *c->columns.state = LEVELS_MOVING;
    }
    return true;
}

// ---- prolongation ----

WISP_KERNEL_LOOP( prolong_loop, run_prolong, prolong, wisp_prolong_args, 1 )

// Adds values of a level to rows of the next finer one, or of the surface, that are not pinned.
static void prolong( const levels_sheet* sheet, const float* value, const float* position, float* target )
{
    const wisp_fabric_level* level = sheet->level;
    prolong_loop loop = { { target, position, value, level->parent_x4, level->weight }, sheet->kernels };
    wisp_parallel_for( sheet->parallel, level->finer_row_count / 8, LEVEL_SLICE_GRAIN, run_prolong, &loop );
}

// Prolongs to the surface. One that nothing pins gets it without its rigid motion, since sheets have no momentum to give, and with a
// shift. The angular momentum of a displacement is about where the substep began, that of a velocity about where it ends.
// @param about [slot][4] m @param change [slot][4] scratch; null: it is pinned
static void prolong_to_surface( const levels_sheet* sheet, const wisp_fabric* fabric, const float* value,
                                const float* about, const float shift[3], float* change, float* target )
{
    if ( change == NULL )
    {
        prolong( sheet, value, about, target );
        return;
    }
    memset( change, 0, 4 * (size_t)fabric->slot_count * sizeof( float ) );
    prolong( sheet, value, about, change );
    const wisp_rigid_args args = { .position = about,
                                   .velocity = change,
                                   .fraction = 1.0f,
                                   .rest = target,
                                   .shift = { shift[0], shift[1], shift[2] } };
    wisp_approach_rigid_motion( sheet->kernels, sheet->parallel, fabric, &args );
}

// ---- a substep ----

// Scratch memory of a substep. All levels share the arrays of links, whose numbers do not overlap.
typedef struct levels_memory
{
    float* at;    // [row][4] of all levels: m, inverse mass in 1/kg
    float* moved; // [row][4] of all levels: m, where the surface has been predicted, then the displacement from there
    float *start, *acceleration; // [row][4] of the level that moves: m, where the substep begins; of the coarsest one
    float *lower, *lambda, *factor; // [link]
    float* change;                  // [slot][4] of a surface that nothing pins; null: it is pinned
    levels_pin* pins;               // of the level that moves
} levels_memory;

static bool take_level_memory( wisp_frame* frame, const wisp_span* span, levels_memory* out )
{
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    const wisp_fabric_level* last = levels_coarsest( f );
    const size_t rows = 4 * (size_t)( last->first_row + last->row_count ), own = 4 * (size_t)f->levels[0].row_count;
    const size_t links = (size_t)( last->first_link + last->schedule.slot_count );
    const size_t pins = (size_t)*levels_columns_of( frame, span->entity ).pins;
    const bool is_pinned = passes_has_pins( f, wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ) );
    const size_t slots = is_pinned ? 0 : 4 * (size_t)f->slot_count;
    float* at = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker,
                                       ( slots + 2 * rows + 2 * own + 3 * links ) * sizeof( float ) +
                                           pins * sizeof( levels_pin ) );
    if ( at == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the coarse sheets of %d particles",
                         f->slot_count );
        return false;
    }
    float* start = at + 2 * rows;
    float* lower = start + 2 * own;
    *out = ( levels_memory ){
        .at = at,
        .moved = at + rows,
        .start = start,
        .acceleration = start + own,
        .lower = lower,
        .lambda = lower + links,
        .factor = lower + 2 * links,
        .change = is_pinned ? NULL : lower + 3 * links,
        .pins = (levels_pin*)( lower + 3 * links + slots ),
    };
    return true;
}

static levels_sheet sheet_of( wisp_frame* frame, const wisp_span* span, const levels_memory* m, int number )
{
    const wisp_fabric_level* level = wisp_frame_fabric( frame, span->entity )->levels + number;
    const float* compliance = wisp_frame_column( frame, span->entity, WISP_LEVEL_COMPLIANCE, 0 );
    const float dt = wisp_frame_dt( frame, span->entity );
    return ( levels_sheet ){
        .level = level,
        .parallel = wisp_frame_parallel( frame, span ),
        .kernels = wisp_frame_kernels( frame ),
        .links = {
            .position = m->at + 4 * (size_t)level->first_row,
            .a_x4 = level->a_x4,
            .b_x4 = level->b_x4,
            .rest = level->rest,
            .compliance = compliance + level->first_link,
            .lower = m->lower + level->first_link,
            .lambda = m->lambda + level->first_link,
            .factor = m->factor + level->first_link,
            .relaxation = dt < LONG_SUBSTEP ? RELAXATION * dt / LONG_SUBSTEP : RELAXATION,
            .start = m->start,
            .particle = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
            .held = HELD_RATE * dt,
            .chain_begin = level->chain_begin,
            .chain_x4 = level->chain_x4,
            .chain_rest = level->chain_rest,
        },
    };
}

static void set_pins( wisp_frame* frame, const wisp_span* span, const levels_memory* m, int number,
                      levels_sheet* sheet )
{
    const levels_surface surface = levels_surface_of( frame, span->entity );
    const int room = *levels_columns_of( frame, span->entity ).pins;
    const int count = room > 0 ? levels_find_pins( &surface, number, m->pins, room ) : 0;
    sheet->pins = m->pins;
    sheet->pin_count = count < room ? count : room;
    sheet->pin_fraction = 1.0f;
}

// Puts the inverse masses of a level next to its positions.
static void set_masses( wisp_frame* frame, const wisp_span* span, const wisp_fabric_level* level, float* at )
{
    const float* inverse_mass = wisp_frame_column( frame, span->entity, WISP_LEVEL_MASS, 0 );
    for ( int row = 0; row < level->row_count; ++row )
    {
        at[4 * row + 3] = inverse_mass[level->first_row + row];
    }
}

// Turns where rows began into their displacement from there.
static void measure_level( const wisp_fabric_level* level, const float* at, float* moved )
{
    for ( int row = 0; row < level->row_count; ++row )
    {
        for ( int i = 4 * row; i < 4 * row + 3; ++i )
        {
            moved[i] = at[i] - moved[i];
        }
        moved[4 * row + 3] = 0.0f;
    }
}

// ---- sheets alone ----

typedef struct scale_loop
{
    const float* previous; // [slot][4]
    float* position;
    float factor;
} scale_loop;

static void run_scale( void* context, int begin, int end, int worker )
{
    (void)worker;
    const scale_loop* loop = context;
    for ( int slot = 8 * begin; slot < 8 * end; ++slot )
    {
        for ( int k = 0, i = 4 * slot; k < 3 && loop->position[4 * slot + 3] > 0.0f; ++k, ++i )
        {
            loop->position[i] = loop->factor * loop->previous[i];
        }
    }
}

// Fraction of its offset from the sheets that a vertex keeps in a substep: most of it is gone after the steps of the blend.
static float kept_offset( wisp_frame* frame, wisp_entity entity )
{
    const float steps = (float)wisp_frame_detail( frame, entity ).blend_steps;
    const float left = steps * (float)wisp_frame_substeps( frame, entity ) - 3.0f;
    return left > 0.0f ? left / ( left + 3.0f ) : 0.0f;
}

// Puts vertices where the finest sheet takes them, with a part of their offset: x' = P X' + kept ( x - P X ), with P the prolongation.
static void follow_sheet( wisp_frame* frame, const wisp_span* span, const levels_sheet* sheet, float* value )
{
    const wisp_fabric_level* level = sheet->level;
    const float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    const float kept = kept_offset( frame, span->entity );
    for ( int row = 0; row < level->row_count; ++row )
    {
        const float *now = sheet->links.position + 4 * row, *before = previous + level->slot_x4[row];
        for ( int k = 0; k < 3; ++k )
        {
            value[4 * row + k] = now[k] - kept * before[k];
        }
        value[4 * row + 3] = 0.0f;
    }
    scale_loop loop = { previous, position, kept };
    wisp_parallel_for( sheet->parallel, level->finer_row_count / 8, LEVEL_SLICE_GRAIN, run_scale, &loop );
    prolong( sheet, value, position, position );
}

// Moves the coarsest sheet from where the surface was. Its velocities are kept for the end of the substep.
// @return false, and it forgets its history, if the surface has torn it apart
static bool move_coarsest( wisp_frame* frame, const wisp_span* span, const levels_sheet* sheet,
                           const levels_memory* m )
{
    const wisp_fabric_level* level = sheet->level;
    const size_t bytes = 4 * (size_t)level->row_count * sizeof( float );
    const float dt = wisp_frame_dt( frame, span->entity );
    float* at = sheet->links.position;
    float* target = m->moved + 4 * (size_t)level->first_row;
    float* velocity = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 0 );
    float* mean = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 3 );
    levels_gather_rows( level, wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ), target );
    levels_gather_rows( level, sheet->links.particle, at );
    levels_gather_rows( level, wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ), m->acceleration );
    set_masses( frame, span, level, at );
    memcpy( mean, at, bytes );
    memcpy( m->start, at, bytes );
    for ( int i = 0; i < 4 * level->row_count; ++i )
    {
        m->acceleration[i] = ( m->acceleration[i] - velocity[i] ) / dt;
    }
    levels_carrier carrier = {
        .sheet = *sheet,
        .rows = { .position = at,
                  .start = m->start,
                  .velocity = velocity,
                  .change = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 1 ),
                  .lag = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 2 ),
                  .acceleration = m->acceleration,
                  .target = target },
        .dt = dt,
        .columns = levels_columns_of( frame, span->entity ),
    };
    if ( m->change != NULL )
    {
        const float* inverse_mass = wisp_frame_column( frame, span->entity, WISP_LEVEL_MASS, 0 );
        levels_find_mean( inverse_mass + level->first_row, 1, m->acceleration, level->vertex_count,
                          carrier.columns.forced );
    }
    if ( levels_move_carrier( &carrier ) == false )
    {
        *carrier.columns.state = LEVELS_FIRST;
        memset( velocity, 0, bytes );
        memset( mean, 0, bytes );
        return false;
    }
    for ( int i = 0; i < 4 * level->row_count; ++i )
    {
        mean[i] = ( at[i] - mean[i] ) / dt;
    }
    measure_level( level, at, target );
    return true;
}

// Moves a finer sheet from where the surface has been predicted, after the next coarser one.
static void move_sheet( wisp_frame* frame, const wisp_span* span, const levels_memory* m, const levels_sheet* coarser,
                        levels_sheet* sheet )
{
    const wisp_fabric_level* level = sheet->level;
    float *at = sheet->links.position, *moved = m->moved + 4 * (size_t)level->first_row;
    levels_gather_rows( level, sheet->links.particle, m->start );
    levels_gather_rows( level, wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ), at );
    memcpy( moved, at, 4 * (size_t)level->row_count * sizeof( float ) );
    set_masses( frame, span, level, at );
    prolong( coarser, m->moved + 4 * (size_t)coarser->level->first_row, at, at );
    levels_find_band( sheet );
    levels_project( sheet, wisp_frame_dt( frame, span->entity ), 1 );
    measure_level( level, at, moved );
}

static void run_levels( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    levels_memory m;
    if ( take_level_memory( frame, span, &m ) == false )
    {
        return;
    }
    int l = wisp_frame_fabric( frame, span->entity )->level_count - 1;
    levels_sheet sheet = sheet_of( frame, span, &m, l );
    set_pins( frame, span, &m, l, &sheet );
    if ( move_coarsest( frame, span, &sheet, &m ) == false )
    {
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1u );
        return;
    }
    while ( l > 0 )
    {
        const levels_sheet coarser = sheet;
        sheet = sheet_of( frame, span, &m, --l );
        set_pins( frame, span, &m, l, &sheet );
        move_sheet( frame, span, &m, &coarser, &sheet );
    }
    if ( wisp_frame_detail( frame, span->entity ).level == WISP_DETAIL_COARSE )
    {
        follow_sheet( frame, span, &sheet, m.moved );
        return;
    }
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    const float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    const float dt = wisp_frame_dt( frame, span->entity );
    const float *a = levels_columns_of( frame, span->entity ).forced, half = -0.5f * dt * dt;
    const float shift[3] = { half * a[0], half * a[1], half * a[2] };
    prolong_to_surface( &sheet, wisp_frame_fabric( frame, span->entity ), m.moved, previous, shift, m.change,
                        position );
}

// Finds half of what forces add in a substep to the mean velocity of a surface that nothing pins: its shift over the time, so that its
// momentum is exact. In contact the mean velocity has changed by less, and gets that fraction.
static void find_shift( const levels_columns* columns, float dt, const float drift[3], float shift[3] )
{
    float both = 0.0f, d2 = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        shift[k] = 0.5f * dt * columns->forced[k];
        both += shift[k] * ( drift[k] - columns->drift[k] );
        d2 += shift[k] * shift[k];
    }
    const float fraction = both >= d2 ? 1.0f : both > 0.0f ? both / d2 : 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        shift[k] *= fraction;
        columns->drift[k] = drift[k] + shift[k];
    }
}

// Adds what second order adds to the velocity of the coarsest sheet, and notes the velocity of the surface for its next substep.
static void pass_velocity_on( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    levels_memory m;
    if ( take_level_memory( frame, span, &m ) == false )
    {
        return;
    }
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    float* motion[5];
    for ( int k = 0; k < 5; ++k )
    {
        motion[k] = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, k );
    }
    const wisp_fabric_level* coarsest = levels_coarsest( f );
    float *value = m.moved + 4 * (size_t)coarsest->first_row, *sum = m.at + 4 * (size_t)coarsest->first_row;
    const wisp_level_added_args added = {
        .surface = velocity,
        .slot_x4 = coarsest->slot_x4,
        .end = motion[0],
        .mean = motion[3],
        .change = motion[1],
        .lag = motion[2],
        .before = motion[4],
        .added = value,
        .sum = sum,
        .a_x4 = coarsest->a_x4,
        .b_x4 = coarsest->b_x4,
        .fraction = coarsest->fraction,
        .link_count = coarsest->schedule.slot_count,
    };
    const bool is_second_order = wisp_frame_kernels( frame )->level_add( &added, coarsest->row_count );
    wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, is_second_order ? 0u : 1u );
    const levels_columns columns = levels_columns_of( frame, span->entity );
    float drift[3] = { 0.0f }, shift[3] = { 0.0f };
    if ( m.change != NULL )
    {
        levels_find_mean( position + 3, 4, velocity, f->slot_count, drift );
        find_shift( &columns, wisp_frame_dt( frame, span->entity ), drift, shift );
    }
    for ( int l = f->level_count - 1; l >= 0; --l )
    {
        const levels_sheet sheet = sheet_of( frame, span, &m, l );
        if ( l > 0 )
        {
            const wisp_fabric_level* finer = f->levels + l - 1;
            float *target = m.moved + 4 * (size_t)finer->first_row, *at = m.at + 4 * (size_t)finer->first_row;
            memset( target, 0, 4 * (size_t)finer->row_count * sizeof( float ) );
            set_masses( frame, span, finer, at );
            prolong( &sheet, value, at, target );
            value = target;
        }
        else
        {
            prolong_to_surface( &sheet, f, value, position, shift, m.change, velocity );
        }
    }
    levels_gather_rows( coarsest, velocity, motion[0] );
}

wisp_status passes_declare_levels( wisp_registry* registry )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "surface.levels_restart", INPUT, ENTITY, levels_restart ),
            .required = { WISP_SURFACE_LEVELS, WISP_LEVEL_MASS, WISP_LEVEL_MOTION },
            .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_VELOCITY, WISP_SURFACE_LEVELS },
            .writes = { WISP_SURFACE_LEVELS, WISP_LEVEL_MASS, WISP_LEVEL_MOTION },
            .should_run = levels_have_restarted,
        },
        {
            WISP_PASS( "surface.levels", PREDICT, ENTITY, run_levels ),
            .required = { WISP_SURFACE_LEVELS, WISP_LEVEL_MASS, WISP_LEVEL_COMPLIANCE, WISP_LEVEL_MOTION },
            .reads = { WISP_SURFACE_LEVELS, WISP_LEVEL_MASS, WISP_LEVEL_COMPLIANCE, WISP_LEVEL_MOTION,
                       WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_POSITION, WISP_SURFACE_LEVELS, WISP_LEVEL_MOTION },
        },
        {
            WISP_PASS( "surface.levels_velocity", VELOCITY, ENTITY, pass_velocity_on ),
            .required = { WISP_SURFACE_LEVELS, WISP_LEVEL_MASS, WISP_LEVEL_MOTION },
            .reads = { WISP_LEVEL_MASS, WISP_LEVEL_MOTION, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY, WISP_LEVEL_MOTION },
        },
    };
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}
