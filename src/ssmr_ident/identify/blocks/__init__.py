"""Blocks pulled over a surface: when the drive starts, when sliding begins, teeth, and all pulls as one fit."""
