/// What a run of a scene was like, as the judges see it: numbers of every body after every step, and what drove it.
#pragma once

#include "world_from_scene.h"

/// A body after a step. Only what moves by itself has energy, strain and speed.
typedef struct stability_sample
{
    double kinetic, potential; ///< J
    double speed;              ///< m/s, of the fastest vertex
    double centre[3];          ///< m, of mass
    double penetration;        ///< m, by which a vertex is nearer to a collider than the thickness; 0: none
    double thickness;          ///< m, of that contact
    int contacts;              ///< vertices that a collider presses on
    bool is_finite;            ///< positions and what is above
    double travel;             ///< m/s: the largest displacement of a vertex in the step, over its length
    double coordinate;         ///< m, the largest of a vertex: its last bit moves by this
    double strain, reach;      ///< the largest |l / l0 - 1| of edges; what load, compliance and solver explain of it
    double energy;             ///< J, kinetic, potential and of violated constraints; NaN: not known
    double stored, bent;       ///< J of that in constraints; J of bending at most, which is not part of it
} stability_sample;

/// A body as it starts, and what it is at the end.
typedef struct stability_body
{
    char name[WISP_SCENE_MAX_NAME + 1];
    bool moves;         ///< has a motion of its own: surfaces, strands with dynamics
    bool is_pinned;     ///< surfaces with pins; strands, whose roots are held
    bool is_carried;    ///< strands on a surface that no collider stops: their roots go where it goes
    bool is_halted;     ///< at the end
    bool starts_inside; ///< of a collider: being pushed out takes its time, and may go two ways at once
    double substep;     ///< s, in a step of the scene's length
    double shortest;    ///< s, in the shortest step
    double mass;        ///< kg, that is free
    double size;        ///< m, diagonal of its bounds at the start
    double area;        ///< m^2, that air meets: triangles; segments times the diameter
    double edge;        ///< m, the shortest edge at rest
    double gravity;     ///< m/s^2
    double damping;     ///< 1/s, of all velocities
    double softness;    ///< stretch that its weight and its solver explain, see stability_trace.c; infinite: no limit
    double stretch;     ///< at the end, the largest l / l0 - 1 of its edges
    double start[3];    ///< m, centre of mass
    double extent;      ///< m, the longest edge of the box around its rest shape
    double twin;        ///< strain that the scene reaches if it starts at rest, twice; infinite: it does
    double burden;      ///< N, the weight of what may lie on it, and the wind
    bool has_contact;   ///< with others
    bool is_uneven;     ///< masses grow along it
    bool starts_away;   ///< from its rest shape, or with a velocity
    int pin_count;      ///< of a surface
} stability_body;

/// What the scene itself brings into motion.
typedef struct stability_inputs
{
    double last;     ///< s, from here on nothing moves, blows, or fills any more; infinite: never
    double speed;    ///< m/s, of the fastest pin, collider, head or event
    double path;     ///< m, that those move in all
    double wind;     ///< m/s, the strongest
    double gas;      ///< J, that gas and atmosphere can do
    double rods;     ///< J, that bent hair stores; infinite: a grid pushes hair apart, or a surface starts strained
    double lift;     ///< N, of buoyancy and outlets
    double drag;     ///< N, that the wind pushes with
    bool moves_pins; ///< pins, heads or colliders move
    bool may_intersect;       ///< contact leaves something out, or hair grows on a surface that it is in contact with
    bool has_colliders_close; ///< two colliders can squeeze what is between them
    bool gains_energy;        ///< documented: projection in the order of the list
    bool works;               ///< something does work that is not counted: a surface on hair, a grid, lift
    bool is_uneven;  ///< energies of constraints cannot be compared: steps vary, or bodies push each other one way
    bool has_events; ///< the last step of the inputs is the one after `last`
} stability_inputs;

struct stability_limits;

typedef struct stability_trace
{
    stability_body* bodies; ///< [body_count] strands and surfaces, in the order of the scene
    int body_count;
    stability_sample* samples; ///< [steps + 1][body_count]; row 0 is the start
    double* times;             ///< [steps + 1] s
    double* near;              ///< [near_count][steps_most + 1] what is to come near a value, after every step
    wisp_vec3* start;          ///< m, all vertices of all bodies; null: nothing is to come near a value
    int steps_most;            ///< of the scene
    const struct stability_limits* limits;         ///< what is near; null: nothing
    int steps;                                     ///< that were made
    wisp_status status;                            ///< of the step that failed, or WISP_OK
    char message[500];                             ///< of that step, or of an entity that was halted
    int intersections_before, intersections_after; ///< of contact, after the first and the last step; -1: not counted
    int intersections_most; ///< after any step but the first, where the scene counts them; -1: not counted
    stability_inputs inputs;
    double depth;  ///< of the lowest vertex at the end below the highest at the start, in sizes of the first body
    uint64_t hash; ///< of the points of all bodies after the last step
    uint64_t resets, not_converged, degenerate; ///< counters at the end
    double rounding;                            ///< m/s, that the last bit of a coordinate is worth in a substep
    double extent; ///< m, diagonal of the bounds of bodies and colliders at the start, without planes
} stability_trace;

static inline stability_sample* stability_sample_of( const stability_trace* trace, int row, int body )
{
    return trace->samples + (size_t)row * (size_t)trace->body_count + body;
}

/// The part of a body that is read after every step.
typedef struct stability_reader stability_reader;

/// Run a scene and take its trace. Changes what the scene requests. @param limits null: no value is to come near another
/// @return what went wrong before the first step
wisp_status stability_trace_run( wisp_scene* scene, const struct stability_limits* limits, stability_trace* out,
                                 wisp_error* error );
void stability_trace_release( stability_trace* trace );

// ---- stability_measure.c ----

/// @return a reader of a body that has made no step; to be freed
stability_reader* stability_reader_make( const scene_world* world, int body );
void stability_reader_free( stability_reader* reader );
/// Read the body as it is now: travel, strain, energy. @param dt s, of the last step; 0: before the first one
void stability_read( stability_reader* reader, const scene_world* world, const stability_body* body, double dt,
                     stability_sample* out );
