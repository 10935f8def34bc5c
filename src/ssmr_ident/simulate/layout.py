"""Where each number sits in the vectors that the robot's compiled loop takes and gives."""

from __future__ import annotations

# Layout of the parameter vector; p_a, contact points, inverse inertia, inertia and gripping wheels follow the scalars.
MASS, KX, KY, KZ, DX, DY, DZ, PATCH_MASS, RADIUS = range(9)
MU_STATIC, MU_KINETIC, LAMBDA_MAX, SLIP_COUPLING, MOTOR_GAIN, GRAVITY_G, RELEASE_DRAG = range(9, 16)
SENSOR, POINTS, INVERSE_INERTIA, INERTIA, GRIPPING = 16, 19, 31, 40, 49
SLIDING_SPEED, AS_PRINTED, PARAMETERS = 53, 54, 55

# x y z roll pitch yaw | u v w p q r | left right | carcass deflections (x, y) of each wheel | sway and its rate (x, y)
# | share of a push's hidden states | how far each wheel was pressed in by it | share of the first value that the
# sensor has not met yet
LOADED, UNSEEN, START = 26, 31, 32
OUTPUTS = ("ax", "ay", "az", "wx", "wy", "wz", "x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "force", "head",
           "rate_left", "rate_right", "sliding", "load_1", "load_2", "load_3", "load_4",
           "force_x_1", "force_x_2", "force_x_3", "force_x_4",
           "force_y_1", "force_y_2", "force_y_3", "force_y_4")  # fmt: skip
