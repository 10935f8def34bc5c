"""What others' tools say of the same recordings: a rig with one mass, driven by a measured force."""

from ssmr_proof.peers.answer import PeerAnswer
from ssmr_proof.peers.grey_box import grey_box
from ssmr_proof.peers.mujoco_sysid import mujoco_sysid
from ssmr_proof.peers.sindy import sindy

PEERS = {"least squares": grey_box, "PySINDy": sindy, "mujoco.sysid": mujoco_sysid}

__all__ = ["PEERS", "PeerAnswer", "grey_box", "mujoco_sysid", "sindy"]
