WISP

