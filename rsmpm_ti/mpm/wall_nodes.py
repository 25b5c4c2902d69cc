"""Nodes one beyond a wall, where quadratic functions reach: what particles gave them goes to the two nodes inside.

v_-1 = 2 v_0 - v_1 there, as `fold_at_walls` has it, but done to node values once per step instead of to the weights of
every particle. Not for an affine transfer: what a particle carries then differs from node to node, so that weights
themselves have to be folded.
"""

import taichi as ti


@ti.func
def fold(columns: ti.template(), walls: ti.template()):
    """Node sums, as a tuple of scalar fields: give what lies beyond walls to the nodes inside."""
    for axis, row, inward, extent in ti.static(walls):
        ti.loop_config(serialize=True)  # a few hundred nodes: waking threads costs more
        for node in ti.grouped(ti.ndrange(*extent)):
            along = inward * ti.Vector.unit(node.n, axis, int)
            wall = node + row * ti.Vector.unit(node.n, axis, int)
            for column in ti.static(columns):
                beyond = column[wall - along]
                if beyond != 0.0:  # on a sparse grid most of a wall has no nodes, and shall get none
                    column[wall] = column[wall] + 2.0 * beyond
                    column[wall + along] = column[wall + along] - beyond
                    column[wall - along] = 0.0


@ti.func
def extend(columns: ti.template(), walls: ti.template()):
    """Node velocities, or their changes: continue them linearly beyond walls."""
    for axis, row, inward, extent in ti.static(walls):
        ti.loop_config(serialize=True)  # a few hundred nodes: waking threads costs more
        for node in ti.grouped(ti.ndrange(*extent)):
            along = inward * ti.Vector.unit(node.n, axis, int)
            wall = node + row * ti.Vector.unit(node.n, axis, int)
            for column in ti.static(columns):
                here, inside = column[wall], column[wall + along]
                if here != 0.0 or inside != 0.0:
                    column[wall - along] = 2.0 * here - inside
