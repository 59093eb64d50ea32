"""The cache of compiled kernels (a stub while the engine is ported)."""
from typing import Any
before_compiling=[]
def checked(dispatcher: Any) -> Any:
    return dispatcher
def load(dispatcher: Any, signature: Any) -> None:
    dispatcher.compile(signature)
    dispatcher.disable_compile()
