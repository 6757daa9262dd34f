"""Write the C source of the extension module wisp._native with cffi.

usage: build_extension.py BINDING_H OUTPUT

The functions are those of app/binding/binding.h. The types that they name are listed here; the compiler checks the list.
"""
import re
import sys

from cffi import FFI

TYPES = """
typedef enum wisp_status { WISP_OK, WISP_NO_MEMORY, WISP_BAD_INPUT, WISP_STALE_ID, WISP_CONFLICT, WISP_IO_ERROR, ... } wisp_status;
typedef struct wisp_error { wisp_status status; char message[500]; ...; } wisp_error;
typedef enum wisp_log_level { WISP_LOG_INFO, WISP_LOG_WARNING, WISP_LOG_ERROR, ... } wisp_log_level;
typedef void wisp_log_fn( void* user, wisp_log_level level, const char* message );
typedef struct wisp_vec3 { float x, y, z; } wisp_vec3;
typedef struct wisp_scene_arrays
{
    const char* file;
    const wisp_vec3* points;
    int point_count;
    const int32_t* triangles;
    int triangle_count;
    const int32_t* offsets;
    int strand_count;
    ...;
} wisp_scene_arrays;
typedef struct wisp_motion_stats
{
    double mass, centre[3], momentum[3], angular_momentum[3], kinetic_energy, potential_energy, volume;
    double strain_max, strain_mean, speed_max;
    ...;
} wisp_motion_stats;
typedef enum wisp_memory_kind { WISP_MEMORY_ENGINE, WISP_MEMORY_MODULE, WISP_MEMORY_COMPONENT, WISP_MEMORY_OUTSIDE, ... } wisp_memory_kind;
typedef struct wisp_memory_part { const char* name; wisp_memory_kind kind; size_t bytes, capacity; ...; } wisp_memory_part;
typedef struct tune_sample { double ms, error, largest; bool is_halted; ...; } tune_sample;
#define TUNE_MAX_PARAMETERS ...
typedef struct tune_trial
{
    int configuration[...];
    tune_sample sample;
    int run_count;
    bool is_pareto;
    ...;
} tune_trial;
typedef struct tune_result
{
    bool meets_target, stopped_early;
    int configuration[...];
    tune_sample achieved;
    tune_trial* trials;
    int trial_count, run_count;
    double seconds;
    ...;
} tune_result;
void tune_release( tune_result* result );
#define WISP_VERSION_STRING ...
typedef enum scene_body_kind { SCENE_BODY_STRANDS, SCENE_BODY_CLOTH, SCENE_BODY_BALLOON, SCENE_BODY_COLLIDER, SCENE_BODY_PLANE, ... } scene_body_kind;
typedef enum scene_request
{
    SCENE_REQUEST_POINTS,
    SCENE_REQUEST_STRAIN,
    SCENE_REQUEST_SPEED,
    SCENE_REQUEST_WIDTH,
    SCENE_REQUEST_COLOUR,
    SCENE_REQUEST_MOTION_STATS,
    SCENE_REQUEST_NORMALS,
    ...
} scene_request;
"""

# Python functions that C calls. Each gets the handle of its object as `user`.
CALLBACKS = """
extern "Python" void wisp_python_log( void* user, wisp_log_level level, const char* message );
extern "Python" bool wisp_python_progress( void* user, int run_count, int max_runs );
extern "Python" bool wisp_python_go_on( void );
"""


def declarations(header):
    """The declarations of a header, without its preprocessor and comments."""
    text = re.sub(r"//[^\n]*", "", header)
    return "\n".join(line for line in text.split("\n") if not line.startswith("#"))


def main():
    header, output = sys.argv[1:]
    with open(header, encoding="utf-8") as file:
        text = file.read()
    ffi = FFI()
    ffi.cdef(TYPES.replace("#define WISP_VERSION_STRING ...", 'static char* const WISP_VERSION_STRING;') + declarations(text) + CALLBACKS)
    ffi.set_source("wisp._native", '#include "binding.h"\n')
    ffi.emit_c_code(output)


main()
