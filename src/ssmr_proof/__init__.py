"""The blind proof: physics concealed by another engine, found by ``ident diagnose``, unsealed and counted."""
