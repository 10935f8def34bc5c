"""What others' tools say of the same recordings: a rig with one mass, driven by a measured force."""

from ssmr_ident.proof.peers.answer import PeerAnswer
from ssmr_ident.proof.peers.grey_box import grey_box
from ssmr_ident.proof.peers.mujoco_sysid import mujoco_sysid
from ssmr_ident.proof.peers.sindy import sindy

PEERS = {"least squares": grey_box, "PySINDy": sindy, "mujoco.sysid": mujoco_sysid}

__all__ = ["PEERS", "PeerAnswer", "grey_box", "mujoco_sysid", "sindy"]
