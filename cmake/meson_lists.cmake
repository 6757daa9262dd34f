# The lists of files and flags stand in the meson.build files, and nowhere else. These functions read them there.

# wisp_read OUT FILE : a meson.build file without its comments. A change of the file configures the build again.
function(wisp_read out file)
    set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(READ "${file}" text)
    string(REGEX REPLACE "#[^\n]*" "" text "${text}")
    set(${out} "${text}" PARENT_SCOPE)
endfunction()

# wisp_strings OUT TEXT PATTERN : the quoted strings of a text that match a pattern as a whole, without their quotes
function(wisp_strings out text pattern)
    string(REGEX MATCHALL "'${pattern}'" found "${text}")
    string(REPLACE "'" "" found "${found}")
    set(${out} "${found}" PARENT_SCOPE)
endfunction()

# wisp_files OUT FOLDER PATTERN : the files that FOLDER/meson.build names and that match a pattern
function(wisp_files out folder pattern)
    wisp_read(text "${folder}/meson.build")
    wisp_strings(names "${text}" "${pattern}")
    list(TRANSFORM names PREPEND "${folder}/")
    set(${out} "${names}" PARENT_SCOPE)
endfunction()

# wisp_folders OUT FOLDER : the folders that FOLDER/meson.build enters and that have sources
function(wisp_folders out folder)
    wisp_read(text "${folder}/meson.build")
    string(REGEX MATCHALL "subdir\\('[^']+'\\)" calls "${text}")
    set(folders)
    foreach(call IN LISTS calls)
        string(REGEX REPLACE "subdir\\('(.*)'\\)" "${folder}/\\1" name "${call}")
        list(APPEND folders "${name}")
    endforeach()
    set(${out} "${folders}" PARENT_SCOPE)
endfunction()

# wisp_module_names OUT FILE : the modules that modules.inc lists
function(wisp_module_names out file)
    wisp_read(text "${file}")
    string(REGEX MATCHALL "WISP_MODULE\\( [a-z_]+" names "${text}")
    list(TRANSFORM names REPLACE "WISP_MODULE\\( " "")
    set(${out} "${names}" PARENT_SCOPE)
endfunction()

# wisp_version OUT FILE : the version in the project() of a meson.build file
function(wisp_version out file)
    file(READ "${file}" text)
    if(NOT text MATCHES "version : '([0-9]+\\.[0-9]+\\.[0-9]+)'")
        message(FATAL_ERROR "${file}: found no version : 'MAJOR.MINOR.PATCH'")
    endif()
    set(${out} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

# wisp_kernel_sets OUT FILE : the names of the instruction sets, and in OUT_<name> the flags of each
function(wisp_kernel_sets out file)
    wisp_read(text "${file}")
    string(REGEX MATCHALL "'[a-z0-9_]+' : \\[[^]]*\\]" rows "${text}")
    set(names)
    foreach(row IN LISTS rows)
        string(REGEX MATCH "^'([a-z0-9_]+)'" name "${row}")
        wisp_strings(flags "${row}" "-[^']*")
        list(APPEND names "${CMAKE_MATCH_1}")
        set(${out}_${CMAKE_MATCH_1} "${flags}" PARENT_SCOPE)
    endforeach()
    set(${out} "${names}" PARENT_SCOPE)
endfunction()
