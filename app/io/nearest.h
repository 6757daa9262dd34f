/// Suggestion of a known word for a mistyped one: for keys of scenes and commands of the command line.
#pragma once

#ifdef __cplusplus
extern "C"
{
#endif

    /// The word of a list that is nearest to `word` by Damerau-Levenshtein distance (a swap of neighbouring letters
    /// counts once; capitals do not count).
    /// @param words [count], none null
    /// @return one of `words`, the first of equals; null if none is within a third of its length (three letters at most)
    const char* nearest_word( const char* word, const char* const* words, int count );

    /// The words of a list that are nearest to `word`, however far they are: nearest first, equals in the order of the list.
    /// @param out [max] receives words @return their number, min(count, max); 0 if `word` has more than 64 letters
    int nearest_words( const char* word, const char* const* words, int count, const char** out, int max );

#ifdef __cplusplus
}
#endif
