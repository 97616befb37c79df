"""Thousands of mesh files at once: `tripatch batch`, on all cores, on a Dask cluster, or as commands for a render farm.

From the command to the files: `command` reads it, `inputs` lists the files, `local` has them done on this machine and
`scheduling` by the workers of a Dask scheduler. `keeper` has them done by a process of its own that may crash, `job` fills one
mesh file and `blender` one .blend. What became of each file goes into the `journal`, by which the next run continues where this
one ended; `record` makes the lines of it, `pictures` the sheet of the worst seams, and `emit` writes the commands and jobs for
render farms.
"""
