/// The files of a tree, and their text.
#pragma once

#include <stdbool.h>

/// Paths relative to the root with '/' between, sorted.
typedef struct layer_tree
{
    char** paths;
    int count, capacity;
} layer_tree;

/// List the files below root/folder. Names that begin with a dot are left out. A missing folder adds nothing.
/// @return false without memory
bool layer_tree_add( layer_tree* tree, const char* root, const char* folder );
void layer_tree_sort( layer_tree* tree );
bool layer_tree_has( const layer_tree* tree, const char* path );
void layer_tree_release( layer_tree* tree );

/// @return the zero-terminated text of root/path, for free(); null if it cannot be read
char* layer_text_read( const char* root, const char* path );

/// Replace C comments by blanks. Line ends and strings stay, so line numbers and #include lines do too.
void layer_text_blank_c( char* text );
/// The same for comments that run from '#' to the end of the line.
void layer_text_blank_hash( char* text );
