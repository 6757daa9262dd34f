# What build_extension.py makes of app/binding/binding.h. cffi has no types.
from typing import Any

ffi: Any
lib: Any
