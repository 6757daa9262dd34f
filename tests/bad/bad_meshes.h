/// Mesh files that must be refused, and words of the message that must follow. Texts and bytes are short enough to
/// stand here; the name says which reader gets them.
#pragma once

#include <stddef.h>

typedef struct bad_mesh
{
    const char* name;
    const char* bytes;
    size_t size;
    const char* words;
} bad_mesh;

#define BAD_MESH( name, bytes, words )                                                                               \
    {                                                                                                                \
        name, bytes, sizeof( bytes ) - 1, words                                                                      \
    }

// ---- good files, which the tests cut and damage ----------------------------------------------------------------

#define GOOD_OBJ "# good\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1/1/1 2//1 4/2\nf -4 -1 -2 -3\n"
#define PLY_VERTICES "property float x\nproperty float y\nproperty float z\n"
#define PLY_FACES "element face 1\nproperty list uchar int vertex_indices\n"
#define PLY_TEXT_HEAD "ply\nformat ascii 1.0\nelement vertex 3\n" PLY_VERTICES PLY_FACES "end_header\n"
#define PLY_LITTLE_HEAD                                                                                              \
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" PLY_VERTICES PLY_FACES "end_header\n"
#define PLY_BIG_HEAD "ply\nformat binary_big_endian 1.0\nelement vertex 3\n" PLY_VERTICES PLY_FACES "end_header\n"
#define GOOD_PLY_TEXT PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
#define ZEROS_12 "\0\0\0\0\0\0\0\0\0\0\0\0"
#define LITTLE_FACE "\3\0\0\0\0\1\0\0\0\2\0\0\0"
#define GOOD_PLY_LITTLE PLY_LITTLE_HEAD ZEROS_12 ZEROS_12 ZEROS_12 LITTLE_FACE
#define GOOD_PLY_BIG PLY_BIG_HEAD ZEROS_12 ZEROS_12 ZEROS_12 "\3\0\0\0\0\0\0\0\1\0\0\0\2"

static const bad_mesh good_meshes[] = {
    BAD_MESH( "good.obj", GOOD_OBJ, "" ),
    BAD_MESH( "good_text.ply", GOOD_PLY_TEXT, "" ),
    BAD_MESH( "good_little.ply", GOOD_PLY_LITTLE, "" ),
    BAD_MESH( "good_big.ply", GOOD_PLY_BIG, "" ),
};

// ---- bad files -------------------------------------------------------------------------------------------------

#define THREE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define FORMAT "ply\nformat ascii 1.0\n"
#define HEAD_OF( vertices, faces )                                                                                   \
    FORMAT "element vertex " vertices "\n" PLY_VERTICES "element face " faces                                        \
           "\nproperty list uchar int vertex_indices\nend_header\n"

static const bad_mesh bad_meshes[] = {
    BAD_MESH( "empty.obj", "", "the file is empty" ),
    BAD_MESH( "zero_byte.obj", "v 0 0\0 0\n", "byte 5: got a zero byte, expected text" ),
    BAD_MESH( "comment_only.obj", "# nothing\n", "got 0 vertices and 0 faces" ),
    BAD_MESH( "no_faces.obj", THREE, "got 3 vertices and 0 faces" ),
    BAD_MESH( "no_vertices.obj", "f 1 2 3\n", "got 0 vertices and 1 faces" ),
    BAD_MESH( "random.obj", "\x93\xf1q\x02\xff\xfe~~\x11", "got 0 vertices and 0 faces" ),
    BAD_MESH( "two_numbers.obj", "v 1 2\n", "line 1: got a vertex of 2 numbers" ),
    BAD_MESH( "five_numbers.obj", "\nv 1 2 3 4 5\n", "line 2: got a vertex of 5 numbers" ),
    BAD_MESH( "eight_numbers.obj", "v 1 2 3 4 5 6 7 8\n", "line 1: got a vertex of 8 numbers" ),
    BAD_MESH( "no_numbers.obj", "v\n", "line 1: got a vertex of 0 numbers" ),
    BAD_MESH( "word.obj", "v 1 two 3\n", "line 1: got \"two\", expected a number" ),
    BAD_MESH( "nan.obj", "v nan 0 0\n", "line 1: got \"nan\", expected a number" ),
    BAD_MESH( "inf.obj", "v 0 -inf 0\n", "line 1: got \"-inf\", expected a number" ),
    BAD_MESH( "hex.obj", "v 0x10 0 0\n", "line 1: got \"0x10\", expected a number" ),
    BAD_MESH( "comma.obj", "v 0,5 0 0\n", "line 1: got \"0,5\", expected a number" ),
    BAD_MESH( "point_alone.obj", "v . 0 0\n", "line 1: got \".\", expected a number" ),
    BAD_MESH( "empty_exponent.obj", "v 1e 0 0\n", "line 1: got \"1e\", expected a number" ),
    BAD_MESH( "long_exponent.obj", "v 1e2147483649 0 0\n", "line 1: got \"1e2147483649\", expected a number" ),
    BAD_MESH( "escape.obj", "v \x1b[31m 0 0\n", "line 1: got \"?[31m\", expected a number" ),
    BAD_MESH( "overflow.obj", THREE "v 0 0 1e39\nf 1 2 3\n", "vertex 3: z is infinite" ),
    BAD_MESH( "double_overflow.obj", "v 0 1e9999 0\nf 1 1 1\n", "vertex 0: y is " ),
    BAD_MESH( "two_corners.obj", THREE "f 1 2\n", "line 4: got a face of 2 corners" ),
    BAD_MESH( "no_corners.obj", THREE "f\n", "line 4: got a face of 0 corners" ),
    BAD_MESH( "index_zero.obj", THREE "f 0 1 2\n", "line 4: got \"0\", expected a corner" ),
    BAD_MESH( "index_beyond.obj", THREE "f 1 2 3\nf 1 2 4\n", "line 5: face 1: got vertex 4, the file has 3" ),
    BAD_MESH( "index_huge.obj", THREE "f 1 2 4294967297\n", "line 4: got \"4294967297\", expected a corner" ),
    BAD_MESH( "max_index.obj", THREE "f 1 2 2147483647\n", "face 0: got vertex 2147483647" ),
    BAD_MESH( "index_before.obj", "v 0 0 0\nf -1 -1 -2\nv 1 1 1\n", "line 2: face 0: got vertex -2, the file has 1" ),
    BAD_MESH( "min_index.obj", THREE "f 1 2 -2147483647\n", "got vertex -2147483647" ),
    BAD_MESH( "index_real.obj", THREE "f 1 2 3.0\n", "line 4: got \"3.0\", expected a corner" ),
    BAD_MESH( "index_word.obj", THREE "f a b c\n", "line 4: got \"a\", expected a corner" ),
    BAD_MESH( "slashes.obj", THREE "f 1/1/1/1 2 3\n", "line 4: got \"1/1/1/1\", expected a corner" ),
    BAD_MESH( "slash_end.obj", THREE "f 1/ 2 3\n", "line 4: got \"1/\", expected a corner" ),
    BAD_MESH( "slash_alone.obj", THREE "f // 2 3\n", "line 4: got \"//\", expected a corner" ),
    BAD_MESH( "continued.obj", THREE "f 1 2 \\\n3\n", "line 4: got \"\\\", expected a corner" ),

    BAD_MESH( "empty.ply", "", "the file is empty" ),
    BAD_MESH( "one_byte.ply", "p", "line 1: the file ends inside the header" ),
    BAD_MESH( "magic.ply", "plx\nformat ascii 1.0\n", "byte 0: expected a first line \"ply\"" ),
    BAD_MESH( "obj_inside.ply", THREE "f 1 2 3\n", "byte 0: expected a first line \"ply\"" ),
    BAD_MESH( "mac_lines.ply", "ply\rformat ascii 1.0\r", "line 1: the file ends inside the header" ),
    BAD_MESH( "header_cut.ply", FORMAT "element vertex 3\nproperty fl", "line 4: the file ends inside the header" ),
    BAD_MESH( "no_format.ply", "ply\nelement vertex 1\n" PLY_VERTICES PLY_FACES "end_header\n", "has no format" ),
    BAD_MESH( "format.ply", "ply\nformat binary 1.0\n", "line 2: got \"binary\", expected ascii" ),
    BAD_MESH( "version.ply", "ply\nformat ascii 2.0\n", "line 2: got \"2.0\", expected version 1.0" ),
    BAD_MESH( "two_formats.ply", FORMAT "format ascii 1.0\n", "line 3: got a second format" ),
    BAD_MESH( "keyword.ply", FORMAT "elements vertex 3\n", "line 3: got \"elements\", expected a keyword" ),
    BAD_MESH( "nameless.ply", FORMAT "element\n", "line 3: got an element without a name" ),
    BAD_MESH( "count_negative.ply", FORMAT "element vertex -1\n",
              "line 3: got \"-1\", expected a number of elements" ),
    BAD_MESH( "count_huge.ply", FORMAT "element vertex 99999999999\n",
              "line 3: got \"99999999999\", expected a number of elements" ),
    BAD_MESH( "too_many_words.ply", FORMAT "element vertex 3 4\n",
              "line 3: got \"4\", expected the end of the line" ),
    BAD_MESH( "two_vertices.ply", FORMAT "element vertex 1\nelement vertex 2\n",
              "line 4: got \"vertex\", expected an element with another name" ),
    BAD_MESH( "early_property.ply", FORMAT "property float x\n", "line 3: got a property before the first element" ),
    BAD_MESH( "type.ply", FORMAT "element vertex 1\nproperty real x\n", "line 4: got \"real\", expected a type" ),
    BAD_MESH( "list_count.ply", FORMAT "element face 1\nproperty list float int vertex_indices\n",
              "line 4: got \"float\", expected an integer type" ),
    BAD_MESH( "list_of_floats.ply", FORMAT "element face 1\nproperty list uchar float vertex_indices\n",
              "line 4: got \"vertex_indices\", expected a list of integers" ),
    BAD_MESH( "scalar_face.ply", FORMAT "element face 1\nproperty int vertex_index\n",
              "line 4: got \"vertex_index\", expected a list of integers" ),
    BAD_MESH( "list_x.ply", FORMAT "element vertex 1\nproperty list uchar float x\n",
              "line 4: got \"x\", expected a single number" ),
    BAD_MESH( "property_name.ply", FORMAT "element vertex 1\nproperty float\n",
              "line 4: got a property without a name" ),
    BAD_MESH( "two_x.ply", FORMAT "element vertex 1\nproperty float x\nproperty int x\n",
              "line 5: got \"x\", expected a property with another meaning" ),
    BAD_MESH( "no_z.ply", FORMAT "element vertex 1\nproperty float x\nproperty float y\n" PLY_FACES "end_header\n",
              "has no property z of vertex" ),
    BAD_MESH( "no_vertex.ply", FORMAT PLY_FACES "end_header\n", "has no element vertex" ),
    BAD_MESH( "points_only.ply", FORMAT "element vertex 1\n" PLY_VERTICES "end_header\n0 0 0\n",
              "has no element face" ),
    BAD_MESH( "strips.ply",
              FORMAT "element vertex 1\n" PLY_VERTICES
                     "element face 1\nproperty list int int strips\nend_header\n0 0 0\n",
              "has no property vertex_indices" ),
    BAD_MESH( "bare_element.ply",
              FORMAT "element vertex 1\n" PLY_VERTICES PLY_FACES "element camera 2000000000\nend_header\n0 0 0\n",
              "the element camera has no property" ),
    BAD_MESH( "no_rows.ply", HEAD_OF( "0", "0" ), "got 0 vertices and 0 faces" ),
    BAD_MESH( "above_cap.ply", HEAD_OF( "67108865", "1" ), "got 67108865 vertices" ),
    BAD_MESH( "announced.ply", HEAD_OF( "60000000", "1" ) "0 0 0\n", "need at least 360000002 bytes, and 7 follow" ),
    BAD_MESH( "text_cut.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n      ",
              "line 13: face 0: vertex_indices is missing" ),
    BAD_MESH( "row_short.ply", PLY_TEXT_HEAD "0 0 0\n1 0\n0 0 1 0\n3 0 1 2\n", "line 11: vertex 1: z is missing" ),
    BAD_MESH( "row_long.ply", PLY_TEXT_HEAD "0 0 0 7\n1 0 0\n0 1 0\n3 0 1 2\n",
              "line 10: vertex 0: one value too many" ),
    BAD_MESH( "row_word.ply", PLY_TEXT_HEAD "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "line 11: vertex 1: y is \"x\"" ),
    BAD_MESH( "row_nan.ply", PLY_TEXT_HEAD "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 10: vertex 0: x is \"nan\"" ),
    BAD_MESH( "row_far.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 1e39\n3 0 1 2\n", "line 12: vertex 2: z is infinite" ),
    BAD_MESH( "face_of_two.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
              "face 0: vertex_indices has 2 corners" ),
    BAD_MESH( "face_short.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
              "line 13: face 0: vertex_indices is missing" ),
    BAD_MESH( "face_long_list.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n99 0 1 2\n",
              "announces a list of 99 values" ),
    BAD_MESH( "face_half.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", "names vertex 1.5, the file has 3" ),
    BAD_MESH( "face_beyond.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "names vertex 3, the file has 3" ),
    BAD_MESH( "face_negative.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "names vertex -1" ),
    BAD_MESH( "count_half.ply", PLY_TEXT_HEAD "0 0 0\n1 0 0\n0 1 0\n2.5 0 1 2\n", "vertex_indices has no length" ),
    BAD_MESH( "text_after.ply", GOOD_PLY_TEXT "3 0 1 2\n", "8 bytes follow the last element" ),
    BAD_MESH( "little_cut.ply", PLY_LITTLE_HEAD ZEROS_12 ZEROS_12, "need at least 37 bytes, and 24 follow" ),
    BAD_MESH( "little_face_cut.ply", PLY_LITTLE_HEAD ZEROS_12 ZEROS_12 ZEROS_12 "\3\0\0\0\0\1\0",
              "face 0: vertex_indices announces a list of 3 values, and the file is too short" ),
    BAD_MESH( "little_after.ply", GOOD_PLY_LITTLE "\3", "1 bytes follow the last element" ),
    BAD_MESH( "little_nan.ply", PLY_LITTLE_HEAD ZEROS_12 "\0\0\0\0\0\0\xc0\x7f\0\0\0\0" ZEROS_12 LITTLE_FACE,
              "vertex 1: y is NaN" ),
    BAD_MESH( "little_inf.ply", PLY_LITTLE_HEAD "\0\0\x80\xff\0\0\0\0\0\0\0\0" ZEROS_12 ZEROS_12 LITTLE_FACE,
              "vertex 0: x is infinite" ),
    BAD_MESH( "little_beyond.ply", PLY_LITTLE_HEAD ZEROS_12 ZEROS_12 ZEROS_12 "\3\0\0\0\0\1\0\0\0\3\0\0\0",
              "names vertex 3, the file has 3" ),
    BAD_MESH( "little_minus.ply", PLY_LITTLE_HEAD ZEROS_12 ZEROS_12 ZEROS_12 "\3\0\0\0\0\1\0\0\0\xff\xff\xff\xff",
              "names vertex -1" ),
    BAD_MESH( "little_called_big.ply", PLY_BIG_HEAD ZEROS_12 ZEROS_12 ZEROS_12 LITTLE_FACE,
              "names vertex 16777216, the file has 3" ),
    BAD_MESH( "list_minus.ply",
              "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" PLY_VERTICES
              "element face 1\nproperty list char int vertex_indices\nend_header\n" ZEROS_12 "\xff\0\0\0\0",
              "face 0: vertex_indices has no length" ),
    BAD_MESH(
        "list_wraps.ply",
        "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" PLY_VERTICES
        "element face 1\nproperty list uint double w\nproperty list uint int vertex_indices\nend_header\n" ZEROS_12
        "\xff\xff\xff\xff\0\0\0\0",
        "w announces a list of 4.29497e+09 values, and the file is too short" ),
};
