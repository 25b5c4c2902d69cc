"""Everything private or pinned about Taichi: how it is started, patched and where it keeps kernels."""
