/// The files of a tree, and their text.
#pragma once

#include <stdbool.h>

/// Paths relative to the root with '/' between, sorted.
typedef struct room_tree
{
    char** paths;
    int count, capacity;
} room_tree;

/// List the files below root/folder. Names that begin with a dot are left out. A folder that is not there adds nothing.
/// @return false without memory
bool room_tree_add( room_tree* tree, const char* root, const char* folder );
void room_tree_sort( room_tree* tree );
bool room_tree_has( const room_tree* tree, const char* path );
void room_tree_release( room_tree* tree );

/// @return the text of root/path with a zero behind it, for free(); null if it cannot be read
char* room_text_read( const char* root, const char* path );

/// Put blanks where C comments are. Line ends and strings stay, so line numbers and #include lines do too.
void room_text_blank_c( char* text );
/// The same for comments that run from '#' to the end of the line.
void room_text_blank_hash( char* text );
